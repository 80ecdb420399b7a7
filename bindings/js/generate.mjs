// What is made of ../api.json: the interface of C as WebAssembly has it, with pointers of 4 bytes.
//
//   node generate.mjs types      TypeScript: constants, layouts and types of structs, functions
//   node generate.mjs exports    flags for the linker
//   node generate.mjs layout     C that does not compile if a layout is another
import { readFileSync } from "node:fs";

const api = JSON.parse(readFileSync(new URL("../api.json", import.meta.url)));
const KINDS = { double: ["f8", 8], uint32_t: ["u4", 4], uint64_t: ["u8", 8], tribo_status: ["i4", 4] };
const ENUMS = {
  Law: "LAW", Mode: "MODE", Solver: "SOLVER", Measure: "MEASURE", Stop: "STOP", Isa: "ISA", Mix: "MIX",
  Kind: "BODY", Skip: "SKIP", Event: "EVENT", Method: "METHOD", ShapeType: "SHAPE", Factors: "SPARSE",
};
// Fields whose numbers are those of an enumeration.
const OF_ENUM = { mode: "Mode", solver: "Solver", stop: "Stop", law: "Law", measure: "Measure", isa: "Isa" };

const camel = (name) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());
// Structs whose plain names are those of classes.
const NAMES = { tribo_contact: "ContactGeometry", tribo_shape: "ShapeData" };
const typeName = (name) => NAMES[name] ?? camel(name.replace("tribo", ""));
const comment = (doc) => (doc ? `/** ${doc.replace(/\*\//g, "* /").replace(/\s+/g, " ")} */\n` : "");

const layouts = new Map();
for (const struct of api.structs) {
  let end = 0;
  let align = 4;
  const fields = struct.fields.map((field) => {
    const inner = field.pointer ? undefined : layouts.get(field.type);
    const [kind, size] = inner ? [field.type, inner.size]
      : (field.pointer ? undefined : KINDS[field.type]) ?? ["pointer", 4];
    const alignment = inner ? inner.align : size;
    const offset = Math.ceil(end / alignment) * alignment;
    end = offset + size * (field.count ?? 1);
    align = Math.max(align, alignment);
    return { name: field.name, kind, offset, count: field.count ?? 0, doc: field.doc };
  });
  layouts.set(struct.name, { size: Math.ceil(end / align) * align, align, fields, doc: struct.doc });
}

function typeOf(field) {
  const one = layouts.has(field.kind) ? typeName(field.kind)
    : field.kind === "u8" && field.name === "id" ? "bigint"
    : OF_ENUM[field.name] ?? "number";
  return field.count > 0 ? (layouts.has(field.kind) ? `${one}[]` : "Vector") : one;
}

function types() {
  const out = ["// Written by generate.mjs.\n",
    "/** A few numbers: a plain array, or a typed one. */\nexport type Vector = ArrayLike<number>;\n"];
  for (const [name, prefix] of Object.entries(ENUMS)) {
    const values = api.constants.filter((c) => c.name.startsWith(`TRIBO_${prefix}_`));
    out.push(`export const ${name} = {\n` + values.map((c) =>
      comment(c.doc) + `${c.name.slice(prefix.length + 7)}: ${c.value},\n`).join("") + "} as const;",
    `export type ${name} = (typeof ${name})[keyof typeof ${name}];\n`);
  }
  const world = api.constants.find((c) => c.name === "TRIBO_WORLD").value;
  out.push(`/** Index of a body that means the immovable world. */\nexport const WORLD = ${world};\n`);
  for (const [name, { fields, doc }] of layouts) {
    const shown = fields.filter((f) => f.kind !== "pointer" && !/^(struct_size|reserved)$/.test(f.name));
    out.push(comment(doc) + `export interface ${typeName(name)} {\n` + shown.map((f) =>
      comment(f.doc) + `${camel(f.name)}: ${typeOf(f)};\n`).join("") + "}\n");
  }
  out.push("export type FieldKind = string;",
    "/** Of a field: its name, kind, offset, and length if it is an array (else 0). */",
    "export type Field = readonly [name: string, kind: FieldKind, offset: number, count: number];",
    "export interface Layout { size: number; fields: readonly Field[] }",
    "export const LAYOUTS: Readonly<Record<string, Layout>> = {");
  for (const [name, { size, fields }] of layouts) {
    out.push(`${name}: { size: ${size}, fields: ${JSON.stringify(fields.map((f) =>
      [camel(f.name), f.kind, f.offset, f.count]))} },`);
  }
  out.push("};", "export interface Structs {");
  for (const name of layouts.keys()) {
    out.push(`${name}: ${typeName(name)};`);
  }
  out.push("}\n", "/** The functions of C; a pointer is its address in the memory. */", "export interface Functions {");
  for (const f of api.functions) {
    const parameters = f.params.map((p) => `${camel(p.name)}: number`).join(", ");
    const plain = f.returns.type === "void" && !f.returns.pointer;
    out.push(comment(f.doc) + `${f.name}(${parameters}): ${plain ? "void" : "number"};`);
  }
  out.push("}");
  return out.join("\n");
}

function layout() {
  const out = ["#include <stddef.h>", ...api.headers.map((h) => `#include <tribo/${h.name}.h>`),
    "#define SAME(name, is) _Static_assert(is, #name)"];
  for (const [name, { size, fields }] of layouts) {
    out.push(`SAME(${name}, sizeof(${name}) == ${size});`, ...fields.map((f) =>
      `SAME(${name}_${f.name}, offsetof(${name}, ${f.name}) == ${f.offset});`));
  }
  return out.join("\n");
}

const exportFlags = () => api.functions.map((f) => `-Wl,--export=${f.name}`).join("\n");
console.log({ types, layout, exports: exportFlags }[process.argv[2]]());
