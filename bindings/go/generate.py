"""Write what this module takes from the C library: `check` fails if it is not what stands here.

    python3 generate.py write|check

types.go: structs and constants of ../api.json. csrc: a copy of the C sources, which `go get` needs
inside of the module, and c_*.c: one file for each that cgo compiles.
"""

import filecmp
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[1]
GO = {"double": "float64", "uint32_t": "uint32", "uint64_t": "uint64", "int32_t": "int32",
      "size_t": "uintptr", "tribo_status": "int32"}
# Structs that users meet; the others are filled inside of the module.
SHOWN = {
    "body": "Body", "material": "Material", "contact": "Contact", "impact_info": "ImpactInfo",
    "solve_info": "SolveInfo", "collision_info": "CollisionInfo", "totals": "Totals",
    "measures": "Measures", "pose": "Pose", "point": "Point", "manifold": "Manifold",
    "system_contact": "SystemContact", "system_info": "SystemInfo", "sparse_info": "SparseInfo",
    "step_info": "StepInfo", "scene_contact": "SceneContact", "scene_event": "SceneEvent",
}
# Compilers' flags that cgo does not let through stand in the sources.
HEAD = """/* Written by generate.py: {what}. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("O3", "no-math-errno", "no-trapping-math", "no-tree-slp-vectorize")
#if defined(__x86_64__)
#pragma GCC target("{target}")
#endif
#endif
#if defined(__GNUC__)
/* The pragma leaves errno to sqrt, which then is no instruction in loops. */
#include <math.h>
extern double sqrt(double) __attribute__((const));
#endif
"""
LEVELS = {"baseline": "no-fma", "x86_64_v3": "arch=x86-64-v3,no-fma",
          "x86_64_v4": "arch=x86-64-v4,prefer-vector-width=512,no-fma"}


def camel(name):
    return "".join(part.capitalize() for part in name.split("_"))


def field_type(field):
    kind = field["type"].removeprefix("tribo_")
    base = SHOWN.get(kind) or GO.get(field["type"], "uintptr")
    base = "uintptr" if "pointer" in field else base
    return f"[{field['count']}]{base}" if "count" in field else base


def comment(text, indent=""):
    return "".join(f"{indent}// {line}".rstrip() + "\n" for line in text.splitlines())


def types(api):
    yield "// Written by generate.py from api.json; not by hand.\n\npackage tribo\n\n"
    yield 'import "unsafe"\n\n'
    yield "// Constants of the C library, by their names without TRIBO_.\nconst (\n"
    for c in api["constants"]:
        name = c["name"].removeprefix("TRIBO_")
        if not name.startswith(("ERROR_", "VERSION_")) and name != "OK":
            yield comment(c["doc"], "\t") + f"\t{camel(name.lower())} uint32 = {c['value']}\n"
    yield ")\n\nconst (\n"
    for c in api["constants"]:
        if c["name"].startswith("TRIBO_ERROR_"):
            name = camel(c["name"].removeprefix("TRIBO_ERROR_").lower())
            yield comment(c["doc"], "\t") + f"\tErr{name} Error = {c['value']}\n"
    yield ")\n\n"
    for s in api["structs"]:
        name = SHOWN.get(s["name"].removeprefix("tribo_"))
        if not name:
            continue
        yield comment(f"{name} is {s['name']} of {s['header']}.h.\n" + s["doc"])
        yield f"type {name} struct {{\n"
        for f in s["fields"]:
            go = camel(f["name"])
            go = go[0].lower() + go[1:] if f["name"] in ("struct_size", "reserved") else go
            yield comment(f["doc"], "\t") + f"\t{go} {field_type(f)}\n"
        yield "}\n\n"
        yield f"var _ = [1]struct{{}}{{}}[unsafe.Sizeof({name}{{}})-{s['size']}]\n\n"


def write(to):
    api = json.loads((TOP / "bindings/api.json").read_text())
    (to / "types.go").write_text("".join(types(api)))
    subprocess.run(["gofmt", "-w", str(to / "types.go")], check=True)
    (to / "csrc/include/tribo").mkdir(parents=True)
    (to / "csrc/src").mkdir()
    for header in sorted((TOP / "include/tribo").glob("*.h")):
        shutil.copyfile(header, to / "csrc/include/tribo" / header.name)
    for source in sorted((TOP / "src").glob("*.[ch]")):
        # Go takes no .c beside the file that keeps the folder in `go mod vendor`.
        name = source.name if source.suffix == ".h" else source.stem + ".inc"
        shutil.copyfile(source, to / "csrc/src" / name)
        if source.suffix == ".c" and source.stem.endswith("_lanes"):
            for level, target in LEVELS.items():
                only = "" if level == "baseline" else "#if defined(__x86_64__)\n"
                end = "" if level == "baseline" else "#endif\n"
                (to / f"c_{source.stem}_{level}.c").write_text(
                    HEAD.format(what="a kernel for one instruction set", target=target) + only +
                    f'#define TRIBO_LANES {level}\n#include "csrc/src/{name}"\n' + end)
        elif source.suffix == ".c":
            (to / f"c_{source.stem}.c").write_text(
                HEAD.format(what="compiled by cgo", target="no-fma") +
                f'#include "csrc/src/{name}"\n')
    for folder, package in (("csrc", "csrc"), ("csrc/src", "src"), ("csrc/include", "include"),
                            ("csrc/include/tribo", "tribo")):
        (to / folder / "keep.go").write_text(
            f"// Package {package} has no code; without it `go mod vendor` would leave its C out.\n"
            f"package {package}\n")


def written(folder):
    return sorted(str(p.relative_to(folder)) for pattern in ("types.go", "c_*.c", "csrc/**/*")
                  for p in folder.glob(pattern) if p.is_file())


def main():
    if sys.argv[1:] not in (["write"], ["check"]):
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as fresh:
        fresh = Path(fresh)
        write(fresh)
        names = written(fresh)
        if sys.argv[1] == "check":
            same = names == written(HERE) and not filecmp.cmpfiles(fresh, HERE, names, False)[1]
            sys.exit(0 if same else "the copy of the C library is stale: python3 generate.py write")
        for name in written(HERE):
            (HERE / name).unlink()
        for name in names:
            (HERE / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(fresh / name, HERE / name)


if __name__ == "__main__":
    main()
