"""Write the C source of tribo._native: cffi's glue for the interface in api.json.

    python native.py api.json _native.c
"""

import json
import sys

from cffi import FFI


def declared(item, name=""):
    """A type as C writes it, around a name."""
    stars = "*" * item.get("pointer", 0)
    const = "const " if item.get("const") else ""
    if "(" in item["type"]:  # a function that a callback is given
        head, tail = item["type"].split("(", 1)
        return f"{head}({stars}{name})({tail}"
    array = f"[{item['count']}]" if "count" in item else ""
    return f"{const}{item['type']} {stars}{name}{array}"


def parameters(function):
    return ", ".join(declared(p, p["name"]) for p in function["params"]) or "void"


def definitions(api):
    yield "typedef int32_t tribo_status;"
    for constant in api["constants"]:
        yield f"#define {constant['name']} {constant['value']}"
    for opaque in api["opaque"]:
        yield f"typedef struct {opaque['name']} {opaque['name']};"
    for struct in api["structs"]:
        yield f"typedef struct {struct['name']} {struct['name']};"
    for callback in api["callbacks"]:
        yield f"typedef {declared(callback['returns'], '(*' + callback['name'] + ')')}" \
              f"({parameters(callback)});"
    for struct in api["structs"]:
        fields = " ".join(f"{declared(field, field['name'])};" for field in struct["fields"])
        yield f"struct {struct['name']} {{ {fields} }};"
    for function in api["functions"]:
        yield f"{declared(function['returns'], function['name'])}({parameters(function)});"


# One contact in one struct: a call with one argument is cheaper for Python than one with six.
PROBLEM = """
typedef struct contact_problem { double w[6], b[3], mu[2], p[3]; } contact_problem;
"""
SOLVE = PROBLEM + """
static tribo_status contact_solve(contact_problem *c)
{
    return tribo_contact_solve(c->w, c->b, c->mu[0], c->mu[1], c->p, NULL);
}
"""


def main(api_path, out_path):
    with open(api_path, encoding="utf-8") as file:
        api = json.load(file)
    ffi = FFI()
    ffi.cdef("\n".join(definitions(api)))
    ffi.cdef(PROBLEM + "tribo_status contact_solve(contact_problem *);")
    headers = "".join(f"#include <tribo/{header['name']}.h>\n" for header in api["headers"])
    ffi.set_source("tribo._native", headers + SOLVE)
    ffi.emit_c_code(out_path)


if __name__ == "__main__":
    main(*sys.argv[1:])
