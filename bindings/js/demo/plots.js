// Strips that show a quantity over the last steps, with its value.
const LENGTH = 300;

export class Plot {
  #values = [];
  #log;
  #canvas = document.createElement("canvas");
  #value = document.createElement("output");

  constructor(parent, name, unit, { log = false } = {}) {
    this.#log = log;
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    caption.append(name, this.#value);
    this.#value.id = name.split(" ")[0];
    this.unit = unit;
    this.#canvas.className = "plot";
    [this.#canvas.width, this.#canvas.height] = [600, 144];
    figure.append(caption, this.#canvas);
    parent.append(figure);
  }

  clear() {
    this.#values = [];
  }

  push(value) {
    this.#values.push(this.#log ? Math.log10(Math.max(value, 1e-17)) : value);
    this.#values.splice(0, this.#values.length - LENGTH);
    this.#value.value = `${value === 0 || (Math.abs(value) >= 0.01 && Math.abs(value) < 1e5)
      ? value.toFixed(2) : value.toExponential(2)} ${this.unit}`;
  }

  draw() {
    const { width, height } = this.#canvas;
    const context = this.#canvas.getContext("2d");
    const low = this.#log ? -17 : Math.min(0, ...this.#values);
    const high = this.#log ? 0 : Math.max(1e-9, ...this.#values);
    context.clearRect(0, 0, width, height);
    context.strokeStyle = "#2f6db3";
    context.lineWidth = 2;
    context.beginPath();
    this.#values.forEach((value, i) => {
      context.lineTo((i / (LENGTH - 1)) * width, height - 4 - ((value - low) / (high - low)) * (height - 8));
    });
    context.stroke();
  }
}
