//! Tells the program whether it is built in its own repository. Gives the Windows program its icon, version and
//! manifest; other systems keep them beside the program.

/// Double-clicked in Explorer, the program opens no console (Windows 11 24H2 and later).
const MANIFEST: &str = r#"<assembly xmlns="urn:schemas-microsoft-com:asm.v1" manifestVersion="1.0">
  <application xmlns="urn:schemas-microsoft-com:asm.v3">
    <windowsSettings>
      <longPathAware xmlns="http://schemas.microsoft.com/SMI/2016/WindowsSettings">true</longPathAware>
      <consoleAllocationPolicy xmlns="http://schemas.microsoft.com/SMI/2024/WindowsSettings">detached</consoleAllocationPolicy>
    </windowsSettings>
  </application>
</assembly>
"#;

fn main() {
    println!("cargo::rerun-if-changed=assets/package/icons/weekender.ico");
    // Unpacked inside another repository, the sources would get the commit of that one.
    println!("cargo::rustc-check-cfg=cfg(has_repository)");
    let own = std::path::Path::new(".git");
    if own.is_file() || own.join("HEAD").is_file() {
        println!("cargo::rustc-cfg=has_repository");
    }
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("windows") {
        return;
    }
    let mut resource = winresource::WindowsResource::new();
    resource.set_icon("assets/package/icons/weekender.ico").set_manifest(MANIFEST);
    if let Err(error) = resource.compile() {
        println!("cargo::warning=the program will have no icon: {error}");
    }
}
