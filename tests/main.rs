//! What crosses crates: the built program, run as its users run it.

mod action;
mod as_clients_draw;
mod bad_input;
mod baselines;
mod batch;
#[path = "browser/browser.rs"]
mod browser;
mod charts;
#[allow(unreachable_pub, reason = "other crates include this file too")]
#[path = "clients/clients.rs"]
mod clients;
mod compress;
mod demo;
mod doors;
mod engine_files;
mod engines;
mod fit;
mod folder;
mod formats;
mod glb;
mod grow;
mod help;
mod independent_reader;
mod level_of;
mod library;
mod lod;
mod lods;
mod main_job;
mod measure;
mod memory;
mod no_larger;
mod npm_package;
mod odd_plants;
mod odd_trees;
mod outputs;
mod preview_page;
mod program;
mod python;
mod release;
mod report_page;
mod scenes;
mod schema;
mod shared_trees;
mod skin;
mod small_files;
mod stand;
mod stream;
mod streams;
mod strips;
mod study;
#[path = "browser/tab.rs"]
mod tab;
mod triangles;
mod user_crate;
#[allow(unreachable_pub, reason = "other crates include this file too")]
#[path = "validator/validator.rs"]
mod validator;
mod web_page;
mod wind;
mod without_leaves;
mod wood;
