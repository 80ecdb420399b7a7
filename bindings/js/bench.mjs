// What a call costs in JavaScript: see ../cost.c. Prints a line of the table.
import { batchSolve, Contact, Isa, numbers, words } from "tribo";

const [COUNT, ALONE, ROUNDS] = [10000, 500, 200]; // few calls a round: the least is then one without others
const MASK = 2n ** 64n - 1n;
let state = 1n;

function unit() {
  state = (state + 0x9e3779b97f4a7c15n) & MASK;
  let z = state;
  z = ((z ^ (z >> 30n)) * 0xbf58476d1ce4e5b9n) & MASK;
  z = ((z ^ (z >> 27n)) * 0x94d049bb133111ebn) & MASK;
  z ^= z >> 31n;
  return Number(z >> 11n) * 2 ** -53;
}

function least(call, count) {
  let best = Infinity;
  for (let round = 0; round < ROUNDS; round++) {
    const start = process.hrtime.bigint();
    call();
    best = Math.min(best, Number(process.hrtime.bigint() - start));
  }
  return best / count;
}

const [w, b, mu, p, modes] = [numbers(6 * COUNT), numbers(3 * COUNT), numbers(2 * COUNT), numbers(3 * COUNT),
  words(COUNT)];
for (let k = 0; k < COUNT; k++) {
  for (let i = 0; i < 6; i++) {
    const side = 2 * unit() - 1;
    w.array[6 * k + i] = [0, 3, 5].includes(i) ? 2 + side : 0.5 * side;
  }
  for (let i = 0; i < 3; i++) {
    b.array[3 * k + i] = 2 * unit() - 1;
  }
  mu.array[2 * k] = 2 * unit();
  mu.array[2 * k + 1] = unit() * mu.array[2 * k];
  unit();
}
const contacts = Array.from({ length: ALONE }, (_, k) => {
  const contact = new Contact();
  contact.numbers.set(w.array.subarray(6 * k, 6 * k + 6));
  contact.numbers.set(b.array.subarray(3 * k, 3 * k + 3), 6);
  contact.numbers.set(mu.array.subarray(2 * k, 2 * k + 2), 9);
  return contact;
});
const alone = least(() => {
  for (const contact of contacts) {
    contact.solve();
  }
}, ALONE);
const batch = least(() => batchSolve(w, b, mu, { p, modes }), COUNT);
const copied = [w, b, mu].map((x) => x.array.slice());
const copying = least(() => batchSolve(...copied), COUNT);
const scalar = least(() => batchSolve(w, b, mu, { p, modes }, Isa.SCALAR), COUNT);
console.log(`JavaScript\t${alone.toFixed(1)}\t${batch.toFixed(1)}`);
if (process.argv.includes("--all")) {
  console.log(`batch: typed arrays that are copied ${copying.toFixed(1)}, contact by contact within wasm ` +
    `${scalar.toFixed(1)} ns`);
}
