//! Runs `secateur simplify`: one tree in, one level out, with its report.

mod contradiction;
mod materials_in_words;
mod options;
mod pictures;
mod pretty;
mod record;

use std::path::Path;

use secateur::{Level, LevelOptions, Opening, Options, Plant, Progress, WoodMode};

use super::advice::{self, warn_all};
use super::args::{self, Common};
use super::failure::Failure;
use super::output::{self, Outputs};
use super::print::Printed;
use super::progress_bar::RunProgress;
use super::streams::Outlet;
use super::work::Work;
use super::{interrupt, machine, order, streams};
pub(crate) use contradiction::contradiction;
pub(crate) use options::{level_options, options};
use pictures::{picture_of, stage_debug_images};
use pretty::pretty;
pub(crate) use record::SimplifyRecord;
use record::Simplifying;

/// Reads, simplifies, writes, reports.
pub(crate) fn run(args: &args::Simplify, common: &Common) -> Result<Printed, Failure> {
    let mut work = Work::on("simplify");
    let outputs = check_outputs(args)?;
    let outlet = Outlet::of(&args.output)?;
    let options = options(args)?;
    let mut plant = opened(args, &options, &outputs, &mut work)?;
    let mut warnings = advice::sentences(&plant.inspection().warnings);
    warn_all(&warnings);
    interrupt::check()?;

    let level = level(&plant, &options, args, common)?;
    let of_run = level.simplified.seconds.iter();
    work.stages
        .extend(of_run.map(|(stage, time)| (stage.name(), *time)));
    work.stages.extend_from_slice(&level.seconds);
    let [of_look, of_level] = warnings_of(&level);
    warn_all(&of_level);
    warnings.extend(of_level);
    warnings.extend(of_look.iter().cloned());
    interrupt::writing()?;
    machine::give_back_free_memory();
    let prepared = work.timed("write", |_| {
        tracing::info!("writing {}", args.output.display());
        Ok(level.prepare(outlet.path(), args.packing.write_options(args.overwrite))?)
    })?;
    let picture = match args.picture {
        Some(_) => Some(work.timed("picture", |_| picture_of(&prepared, args, &plant, &level))?),
        None => None,
    };
    let (written, files) = prepared.into_files();
    work.files.append(files);
    let (figures, views_that_judge) = (level.record(), level.views_that_judge());
    let level = level.into_parts();
    let result = &level.simplified;
    if let (Some(path), Some(picture)) = (&args.picture, picture) {
        output::stage(&mut work.files, path, &picture)?;
    }
    if let Some(path) = &args.order {
        let (order, how) = (
            result.passes.in_one_order(),
            args.packing.write_options(args.overwrite),
        );
        order::stage(&mut work.files, path, order, &mut plant, how)?;
    }
    if let Some(folder) = &args.debug_images {
        stage_debug_images(&mut work.files, folder, &level.options, &plant, result)?;
    }
    let run = Simplifying {
        input: &args.tree,
        plant: &plant,
        level: &level,
        record: figures,
        views_that_judge,
        written: &written,
        warnings: &warnings,
    };
    let (record, total) = work.record(run.record(args));
    let record = outlet.renamed(record);
    work.finish(args.report.as_deref(), &record)?;
    outlet.send()?;
    warn_all(&of_look);
    Ok(Printed::single(pretty(&run, args, total), record))
}

/// The plant, with what stands about it.
fn opened(
    args: &args::Simplify,
    options: &Options,
    outputs: &[&Path],
    work: &mut Work,
) -> Result<Plant, Failure> {
    let surroundings = work.timed("scene", |_| args.scene.read(args.memory.memory, outputs))?;
    let opening = Opening {
        foliage: args.foliage.foliage.clone(),
        not_plant: args.not_plant.not_plant.clone(),
        vertex_alpha: args.vertex_alpha.vertex_alpha,
        wood: match args.wood {
            Some(wood) => wood,
            None if !args.level_of.is_empty() => WoodMode::Auto,
            None => LevelOptions::usual_wood(options.target),
        },
        wind: args.wind.wind,
        memory: args.memory.memory,
    };
    let plant = work.timed("load", |_| {
        tracing::info!("reading {}", args.tree.display());
        Ok(streams::plant(&args.tree, &opening)?.within(surroundings))
    })?;
    output::check_spares(plant.tree().document(), outputs)?;
    Ok(plant)
}

/// What has to be said of a level: of how it looks, and the rest.
fn warnings_of(level: &Level) -> [Vec<String>; 2] {
    let of = |is_of_look: bool| {
        let warnings = level.warnings.iter();
        let warnings = warnings.filter(|warning| warning.is_of_look() == is_of_look);
        warnings.map(advice::of_level).collect()
    };
    [of(true), of(false)]
}

/// The outputs, none of which is known to be in the way of another file.
fn check_outputs(args: &args::Simplify) -> Result<Vec<&Path>, Failure> {
    let views = args.views.as_deref().map(Path::new);
    let inputs = std::iter::once(args.tree.as_path()).chain(views);
    let written = args.packing.write_options(args.overwrite);
    let outputs = Outputs::beside(inputs.chain(args.scene.files()))
        .and(&args.output, |path, inputs| {
            match streams::is_stream(path) {
                true => Ok(()),
                false => output::check_tree(path, inputs, written),
            }
        })?
        .maybe(args.report.as_ref(), output::check_file)?
        .maybe(args.order.as_ref(), |path, inputs| {
            order::check(path, inputs, written)
        })?
        .maybe(args.picture.as_ref(), output::check_picture)?;
    if let Some(folder) = &args.debug_images {
        output::check_folder(folder)?;
    }
    outputs.distinct()
}

fn level(
    plant: &Plant,
    options: &Options,
    args: &args::Simplify,
    common: &Common,
) -> Result<Level, Failure> {
    let progress_bar = RunProgress::new(common, &args.tree.display().to_string());
    let options = level_options(args, options.clone());
    let level = plant.level_watched(&options, &mut |progress| {
        if let Progress::Stage(_) = progress {
            machine::give_back_free_memory();
        }
        progress_bar.show(progress)
    });
    level.map_err(Failure::about(&args.tree))
}
