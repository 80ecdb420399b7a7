/** Objects that own something of C: closed once, entered by one call at a time. */
import { owned, released } from "./memory.js";

export abstract class Owner {
  readonly #handle: number;
  readonly #destroy: (handle: number) => void;
  #closed = false;
  #inside = false;

  protected constructor(handle: number, destroy: (handle: number) => void) {
    this.#handle = handle;
    this.#destroy = destroy;
    owned(this, () => destroy(handle));
  }

  /** The handle for one call: a callback that comes back while it runs is refused. */
  protected alone<T>(call: (handle: number) => T): T {
    if (this.#inside) {
      throw new Error(`this ${this.constructor.name} is in use, by a call that this one came from`);
    }
    if (this.#closed) {
      throw new Error(`this ${this.constructor.name} is closed`);
    }
    this.#inside = true;
    try {
      return call(this.#handle);
    } finally {
      this.#inside = false;
    }
  }

  /** Free what it owns; any later call throws. Closing twice is nothing. */
  close(): void {
    if (!this.#closed) {
      this.alone((handle) => {
        this.#closed = true;
        released(this);
        this.#destroy(handle);
      });
    }
  }
}
