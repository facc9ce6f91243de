//! Prints the adapter that the GPU tests would run on, or fails with a sentence
//! if there is none that computes correctly.

use std::process::ExitCode;

use secateur_raster::gpu::{Device, Preference};

fn main() -> ExitCode {
    match Device::find(Preference::Any) {
        Ok(device) => {
            println!("{} ({})", device.adapter(), device.driver());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
