"""Write tribo-sys/src/bindings.rs from ../api.json; `check` fails if it is not what stands there.

    python3 generate.py write|check
"""

import json
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
OUT = HERE / "tribo-sys/src/bindings.rs"
PLAIN = {"double": "f64", "uint32_t": "u32", "uint64_t": "u64", "int32_t": "i32", "size_t": "usize",
         "char": "c_char", "void": "c_void", "tribo_status": "tribo_status"}
WORDS = {"type", "move", "ref", "in", "fn", "box", "use", "where"}


def rust(item, callbacks):
    kind = item["type"]
    if "(" in kind:  # void (void *, uint32_t): the task of a parallel loop
        return "Option<unsafe extern \"C\" fn(data: *mut c_void, i: u32)>"
    name = PLAIN.get(kind, f"Option<{kind}>" if kind in callbacks else kind)
    for level in range(item.get("pointer", 0)):
        is_const = item.get("const") and level == 0
        name = f"*{'const' if is_const else 'mut'} {name}"
    return name


def parameter(item, callbacks):
    if "count" in item:  # an array as parameter is a pointer
        base = rust({**item, "pointer": item.get("pointer", 0)}, callbacks)
        const = "const" if item.get("const") else "mut"
        return f"*{const} {PLAIN.get(item['type'], item['type'])}" if "pointer" not in item \
            else f"*{const} {base}"
    return rust(item, callbacks)


def field(item, callbacks):
    base = rust(item, callbacks)
    return f"[{base}; {item['count']}]" if "count" in item else base


def word(name):
    return f"r#{name}" if name in WORDS else name


def doc(text, indent=""):
    text = re.sub(r"<([^>\s]+)>", r"`<\1>`", text)
    text = text.replace("[", "\\[").replace("]", "\\]")
    return "".join(f"{indent}/// {line}".rstrip() + "\n" for line in text.splitlines())


def signature(function, callbacks):
    params = ", ".join(f"{word(p['name'])}: {parameter(p, callbacks)}" for p in function["params"])
    returns = function["returns"]
    is_void = returns["type"] == "void" and "pointer" not in returns
    return f"({params})" + ("" if is_void else f" -> {rust(returns, callbacks)}")


def generated(api):
    callbacks = {callback["name"] for callback in api["callbacks"]}
    yield "// Written by generate.py from api.json; not by hand.\n\n"
    yield "use core::ffi::{c_char, c_void};\n\n"
    yield "pub type tribo_status = i32;\n\n"
    for c in api["constants"]:
        kind = "tribo_status" if c["name"].startswith(("TRIBO_ERROR_", "TRIBO_OK")) else "u32"
        yield doc(c["doc"]) + f"pub const {c['name']}: {kind} = {c['value']};\n"
    yield "\n"
    for o in api["opaque"]:
        yield doc(o["doc"]) + f"#[repr(C)]\npub struct {o['name']} {{\n    _private: [u8; 0],\n}}\n\n"
    for c in api["callbacks"]:
        yield doc(c["doc"]) + f"pub type {c['name']} =\n    unsafe extern \"C\" fn" \
            f"{signature(c, callbacks)};\n\n"
    for s in api["structs"]:
        yield doc(s["doc"]) + "#[repr(C)]\n#[derive(Clone, Copy, Debug)]\n"
        yield f"pub struct {s['name']} {{\n"
        for f in s["fields"]:
            yield doc(f["doc"], "    ") + f"    pub {word(f['name'])}: {field(f, callbacks)},\n"
        yield "}\n\n"
        yield f"impl Default for {s['name']} {{\n    /// All zeros.\n    fn default() -> Self {{\n" \
            "        // SAFETY: numbers, null pointers and absent functions are all zeros.\n" \
            "        unsafe { core::mem::zeroed() }\n    }\n}\n\n"
        yield "#[cfg(target_pointer_width = \"64\")]\n" \
            f"const _: () = assert!(core::mem::size_of::<{s['name']}>() == {s['size']});\n\n"
    yield "extern \"C\" {\n"
    for f in api["functions"]:
        yield doc(f["doc"], "    ") + f"    pub fn {f['name']}{signature(f, callbacks)};\n"
    yield "}\n"


def main():
    api = json.loads((HERE.parent / "api.json").read_text())
    text = "".join(generated(api))
    if sys.argv[1:] == ["write"]:
        OUT.write_text(text)
    elif sys.argv[1:] == ["check"]:
        sys.exit(0 if OUT.exists() and OUT.read_text() == text else
                 "bindings.rs is stale: python3 generate.py write")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
