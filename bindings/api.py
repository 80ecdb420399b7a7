"""The public interface of tribo as data: bindings/api.json, from the headers.

    python3 api.py write     read include/tribo/*.h and write api.json anew
    python3 api.py check     fail if api.json is stale, or if a public function is neither used by
                             the sources of a binding nor named, with a reason, in its skip.txt

write, and the first half of check, need libclang for Python (PyPI: libclang). What a declaration
means stays in its comment, which is carried over as it stands. Bindings generate their raw layers
from api.json alone.
"""

import json
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
INCLUDE = HERE.parent / "include"
API = HERE / "api.json"
FULL = ("shape", "collide", "sparse", "broad", "scene")  # headers of libtribo; others: libtribo_core
# Where the functions of a binding are used: patterns of files, relative to its folder.
# Enough of libc for the headers, so that the result is the same on every machine.
LIBC = {
    "libc/stddef.h": "typedef unsigned long size_t;\n#define NULL ((void *)0)\n",
    "libc/stdint.h": "".join(
        f"typedef {sign}{base} {prefix}int{bits}_t;\n"
        for bits, base in ((8, "char"), (16, "short"), (32, "int"), (64, "long"))
        for sign, prefix in (("signed ", ""), ("unsigned ", "u"))
    )
    + "#define UINT32_MAX 4294967295u\n",
}
USES = {
    "cpp": ["include/**/*.hpp"],
    "python": ["src/tribo/*.py"],
    "rust": ["tribo/src/**/*.rs"],
    "go": ["*.go"],
    "js": ["src/*.ts", "src/*.js"],
}


# ---- reading the headers -------------------------------------------------------------------------


def text_of(comment):
    """A doc comment without its stars."""
    if not comment:
        return ""
    lines = re.sub(r"^/\*\*<?|\*/$", "", comment.strip()).splitlines()
    return "\n".join(re.sub(r"^\s*\*? ?", "", line).rstrip() for line in lines).strip()


class Reader:
    def __init__(self):
        import clang.cindex as cindex

        self.cindex = cindex
        headers = sorted(path.name for path in (INCLUDE / "tribo").glob("*.h"))
        source = "".join(f"#include <tribo/{name}>\n" for name in headers)
        options = cindex.TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD
        self.unit = cindex.Index.create().parse(
            "all.c",
            args=["-std=c99", "-nostdinc", f"-I{INCLUDE}", "-Ilibc", "-target", "x86_64-linux-gnu"],
            unsaved_files=[("all.c", source), *LIBC.items()],
            options=options,
        )
        errors = [d for d in self.unit.diagnostics if d.severity >= cindex.Diagnostic.Error]
        if errors:
            sys.exit(f"api.py: {errors[0]}")
        self.headers = headers

    def declarations(self):
        for cursor in self.unit.cursor.get_children():
            path = Path(cursor.location.file.name) if cursor.location.file else None
            if path and path.parent.name == "tribo" and path.parent.parent == INCLUDE:
                yield path.stem, cursor

    def type_of(self, clang_type):
        """{"type": name} with "count" for arrays, "pointer" levels and "const" of what is meant."""
        kind = self.cindex.TypeKind
        out = {}
        if clang_type.kind in (kind.CONSTANTARRAY, kind.INCOMPLETEARRAY):
            out["count"] = clang_type.element_count if clang_type.kind == kind.CONSTANTARRAY else 0
            clang_type = clang_type.element_type
        levels = 0
        while clang_type.kind == kind.POINTER:
            levels += 1
            clang_type = clang_type.get_pointee()
        if clang_type.is_const_qualified():
            out["const"] = True
        if levels:
            out["pointer"] = levels
        spelling = clang_type.spelling.replace("const ", "").replace("struct ", "")
        return {"type": spelling, **out}

    def parameters(self, cursor):
        kind = self.cindex.CursorKind.PARM_DECL
        for parameter in cursor.get_children():
            if parameter.kind == kind:
                # Clang turns double[3] into a pointer; the written type still has the length.
                written = self.type_of(parameter.type)
                tokens = "".join(token.spelling for token in parameter.get_tokens())
                length = re.search(r"\[(\d+)\]$", tokens)
                if length and "count" not in written:
                    written["count"] = int(length.group(1))
                    written["pointer"] = written.get("pointer", 1) - 1
                if written.get("pointer") == 0:
                    del written["pointer"]
                yield {"name": parameter.spelling, **written}

    def structs(self, cursor):
        fields = [
            {
                "name": field.spelling,
                **self.type_of(field.type),
                "offset": cursor.type.get_offset(field.spelling) // 8,
                "doc": text_of(field.raw_comment),
            }
            for field in cursor.type.get_fields()
        ]
        return {"size": cursor.type.get_size(), "align": cursor.type.get_align(), "fields": fields}


def is_callback(reader, cursor):
    kind = reader.cindex.TypeKind
    target = cursor.underlying_typedef_type
    return target.kind == kind.POINTER and target.get_pointee().get_canonical().kind in (
        kind.FUNCTIONPROTO,
    )


def macros(name):
    """Plain numbers that a header defines."""
    text = (INCLUDE / "tribo" / f"{name}.h").read_text()
    for match in re.finditer(r"^#define (TRIBO_[A-Z0-9_]+) (\d+|UINT32_MAX)$", text, re.M):
        value = 2**32 - 1 if match.group(2) == "UINT32_MAX" else int(match.group(2))
        yield {"name": match.group(1), "value": value, "header": name, "doc": ""}


def read():
    reader = Reader()
    kind = reader.cindex.CursorKind
    api = {"version": "", "headers": [], "constants": [], "structs": [], "opaque": [],
           "callbacks": [], "functions": []}
    known = set()
    for name in (Path(header).stem for header in reader.headers):
        library = "tribo" if name in FULL else "tribo_core"
        api["headers"].append({"name": name, "library": library})
        api["constants"] += macros(name)
    structs = {}
    for header, cursor in reader.declarations():
        about = {"header": header, "doc": text_of(cursor.raw_comment)}
        if cursor.kind == kind.ENUM_DECL:
            for value in cursor.get_children():
                api["constants"].append({"name": value.spelling, "value": value.enum_value,
                                         "header": header, "doc": text_of(value.raw_comment)})
        elif cursor.kind == kind.STRUCT_DECL and cursor.is_definition():
            structs[cursor.spelling] = {"name": cursor.spelling, **about,
                                        **reader.structs(cursor)}
        elif cursor.kind == kind.TYPEDEF_DECL and cursor.spelling not in known:
            known.add(cursor.spelling)
            if is_callback(reader, cursor):
                result = cursor.underlying_typedef_type.get_pointee().get_result()
                api["callbacks"].append({"name": cursor.spelling, **about,
                                         "returns": reader.type_of(result),
                                         "params": list(reader.parameters(cursor))})
            elif cursor.spelling in structs:
                structs[cursor.spelling]["doc"] = structs[cursor.spelling]["doc"] or about["doc"]
                api["structs"].append(structs[cursor.spelling])
            elif cursor.underlying_typedef_type.get_canonical().kind == \
                    reader.cindex.TypeKind.RECORD:
                api["opaque"].append({"name": cursor.spelling, **about})
        elif cursor.kind == kind.FUNCTION_DECL and cursor.spelling not in known:
            known.add(cursor.spelling)
            library = "tribo" if header in FULL else "tribo_core"
            api["functions"].append({"name": cursor.spelling, "library": library, **about,
                                     "returns": reader.type_of(cursor.result_type),
                                     "params": list(reader.parameters(cursor))})
    values = {constant["name"]: constant["value"] for constant in api["constants"]}
    api["version"] = ".".join(str(values[f"TRIBO_VERSION_{part}"])
                              for part in ("MAJOR", "MINOR", "PATCH"))
    return json.dumps(api, indent=1, ensure_ascii=False) + "\n"


# ---- checks --------------------------------------------------------------------------------------


def skipped(folder):
    """name -> reason, from lines "name: reason"; a name may end in *."""
    lines = (folder / "skip.txt").read_text().splitlines() if (folder / "skip.txt").exists() else []
    pairs = [line.split(":", 1) for line in lines if line and not line.startswith("#")]
    return {name.strip(): reason.strip() for name, reason in pairs}


def is_skipped(name, skips):
    return any(name == skip or (skip.endswith("*") and name.startswith(skip[:-1]))
               for skip in skips)


def coverage(binding, functions):
    """What is wrong with a binding: functions that it leaves out, and needless lines to skip."""
    folder = HERE / binding
    sources = "\n".join(path.read_text() for pattern in USES[binding]
                        for path in sorted(folder.glob(pattern)))
    used = set(re.findall(r"\btribo_\w+", sources))
    skips = skipped(folder)
    for name in functions:
        if name not in used and not is_skipped(name, skips):
            yield f"{binding}: {name} is neither bound nor in skip.txt"
    for name, reason in skips.items():
        matches = [f for f in functions if is_skipped(f, [name])]
        if not matches or not reason:
            yield f"{binding}: skip.txt: {name} names no public function, or gives no reason"
        elif all(match in used for match in matches):
            yield f"{binding}: skip.txt: {name} is bound"


def check():
    try:
        if read() != API.read_text():
            yield "api.json is stale: python3 api.py write"
    except ImportError:
        print("# SKIP of the comparison with the headers: no libclang for Python")
    functions = [function["name"] for function in json.loads(API.read_text())["functions"]]
    for binding in USES:
        if (HERE / binding).is_dir():
            yield from coverage(binding, functions)


def main():
    if sys.argv[1:] == ["write"]:
        API.write_text(read())
    elif sys.argv[1:] == ["check"]:
        wrong = list(check())
        for line in wrong:
            print(line)
        sys.exit(1 if wrong else 0)
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
