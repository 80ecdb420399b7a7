/** Errors: a class for each status of the C library. */
import { c, text } from "./wasm.js";

/** A call that the C library refused; nothing was changed. */
export class TriboError extends Error {
  /** The status: its number, and its name in C. */
  readonly status: number;
  readonly code: string;

  constructor(status: number, where: string, options?: ErrorOptions) {
    super(`${where}: ${text(c.tribo_status_string(status))}`, options);
    this.status = status;
    this.code = text(c.tribo_status_name(status));
    this.name = new.target.name;
  }
}

export class NullError extends TriboError {}
export class StructSizeError extends TriboError {}
export class OptionError extends TriboError {}
export class IndexError extends TriboError {}
export class IsaError extends TriboError {}
export class UnknownNameError extends TriboError {}
export class AliasError extends TriboError {}
export class CapacityError extends TriboError {}
export class OutOfMemoryError extends TriboError {}
export class DataError extends TriboError {}
export class NotFiniteError extends TriboError {}
export class RangeOfValueError extends TriboError {}
export class NormalError extends TriboError {}
export class OrientationError extends TriboError {}
export class FrameError extends TriboError {}
export class MassError extends TriboError {}
export class InertiaError extends TriboError {}
export class ShapeError extends TriboError {}
export class TimeStepError extends TriboError {}
export class DegenerateError extends TriboError {}
export class SupportError extends TriboError {}
export class PairError extends TriboError {}
export class FrictionError extends TriboError {}
export class RestitutionError extends TriboError {}
export class ContactMatrixError extends TriboError {}
export class ImmovableError extends TriboError {}
export class JamError extends TriboError {}

const CLASSES: Readonly<Record<number, typeof TriboError>> = {
  10: NullError, 11: StructSizeError, 12: OptionError, 13: IndexError, 14: IsaError,
  15: UnknownNameError, 16: AliasError, 17: CapacityError, 18: OutOfMemoryError, 19: DataError,
  20: NotFiniteError, 21: RangeOfValueError, 22: NormalError, 23: OrientationError, 24: FrameError,
  30: MassError, 31: InertiaError, 32: ShapeError, 33: TimeStepError, 34: DegenerateError,
  35: SupportError, 36: PairError, 40: FrictionError, 41: RestitutionError, 50: ContactMatrixError,
  51: ImmovableError, 52: JamError,
};

export const CAPACITY = 17;
export const MEMORY = 18;

/** The error of a status; a plain TriboError for one that this version does not know. */
export function errorOf(status: number, where = "tribo", options?: ErrorOptions): TriboError {
  return new (CLASSES[status] ?? TriboError)(status, where, options);
}

/** Throw the error of a status other than TRIBO_OK. */
export function check(status: number, where = "tribo"): void {
  if (status !== 0) {
    throw errorOf(status, where);
  }
}
