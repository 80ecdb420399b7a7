//! Builds the C libraries from the sources in `c`, or finds installed ones (feature pkg-config).

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "pkg-config")]
    pkg_config::Config::new().atleast_version("0.1.0").probe("tribo").expect("libtribo");
    #[cfg(not(feature = "pkg-config"))]
    build();
}

#[cfg(not(feature = "pkg-config"))]
fn build() {
    use std::path::{Path, PathBuf};

    const SYSTEM: [(&str, &str); 6] = [
        ("ccd", "ccd/ccd.h"),
        ("qhull_r", "libqhull_r/libqhull_r.h"),
        ("cholmod", "suitesparse/cholmod.h"),
        ("klu", "suitesparse/klu.h"),
        ("umfpack", "suitesparse/umfpack.h"),
        ("suitesparseconfig", "suitesparse/SuiteSparse_config.h"),
    ];
    let source = Path::new("c/src");
    println!("cargo:rerun-if-changed=c/src");
    println!("cargo:rerun-if-changed=c/include");

    // The promise of equal bits rests on these flags: see the Makefile of the C library.
    let base = || {
        let mut build = cc::Build::new();
        build
            .std("c99")
            .opt_level(3)
            .include("c/include")
            .define("TRIBO_BUILD", None)
            .flag("-ffp-contract=off")
            .flag("-fno-math-errno")
            .flag("-fno-trapping-math")
            .flag("-fno-tree-slp-vectorize")
            .flag("-fvisibility=hidden")
            .cargo_metadata(false);
        build
    };
    let target = std::env::var("CARGO_CFG_TARGET_ARCH").unwrap_or_default();
    let mut levels = vec![("baseline", None)];
    let mut plain = base();
    if target == "x86_64" {
        levels.push(("x86_64_v3", Some("-march=x86-64-v3")));
        levels.push(("x86_64_v4", Some("-march=x86-64-v4")));
        plain.define("TRIBO_HAVE_X86_64_LEVELS", "1").flag("-mno-fma");
    }
    let mut files: Vec<PathBuf> = std::fs::read_dir(source)
        .expect("c/src")
        .map(|entry| entry.expect("c/src").path())
        .filter(|path| path.extension().is_some_and(|e| e == "c"))
        .collect();
    files.sort();
    let (lanes, files): (Vec<_>, Vec<_>) =
        files.into_iter().partition(|path| path.to_string_lossy().ends_with("_lanes.c"));

    let mut all = cc::Build::new();
    all.objects(plain.files(files).compile_intermediates());
    for (name, march) in levels {
        let mut build = base();
        // Objects are named by their source: each level needs a folder of its own.
        build.out_dir(Path::new(&std::env::var("OUT_DIR").unwrap()).join(name));
        build.define("TRIBO_LANES", name);
        if target == "x86_64" {
            build.define("TRIBO_HAVE_X86_64_LEVELS", "1");
        }
        if let Some(march) = march {
            build.flag(march);
        }
        if target == "x86_64" {
            build.flag("-mno-fma");
        }
        if name == "x86_64_v4" {
            build.flag("-mprefer-vector-width=512");
        }
        all.objects(build.files(&lanes).compile_intermediates());
    }
    all.compile("tribo_all");
    for (library, header) in SYSTEM {
        let is_there = ["/usr/include", "/usr/local/include", "/opt/homebrew/include"]
            .iter()
            .any(|root| Path::new(root).join(header).exists());
        if !is_there {
            println!("cargo:warning={header} was not found; on Debian: apt-get install \
                      libccd-dev libqhull-dev libsuitesparse-dev");
        }
        println!("cargo:rustc-link-lib={library}");
    }
    println!("cargo:rustc-link-lib=m");
    println!("cargo:include={}/c/include", std::env::var("CARGO_MANIFEST_DIR").unwrap());
}
