//! Prints the text of a shader: `cargo run --example gpu_shader [path_trace|resolve|probe]`.

use weekender::render_gpu::shader_source::{EntryPoint, source};

fn main() {
    let wanted = std::env::args().nth(1).unwrap_or_else(|| "path_trace".to_owned());
    match EntryPoint::ALL.into_iter().find(|entry_point| entry_point.name() == wanted) {
        Some(entry_point) => println!("{}", source(entry_point)),
        None => eprintln!("there is no entry point {wanted}; there are path_trace, resolve and probe"),
    }
}
