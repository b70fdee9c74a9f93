/** A document that breaks the format. */
export class DiffmaError extends Error {
  /** JSON path of the fault, such as `$.records.b[3]`. */
  readonly path: string;
  readonly expected: string;
  readonly found: string;
}

export interface DecodeOptions {
  /** Take the coarsest level of detail whose bound is at most this; else the records themselves. */
  bound?: number;
}

export interface Params {
  /** `"DiffMAx"`: bounds or orders per channel, which the published algorithm does not know. */
  class: "DiffMA" | "DiffMAx";
  bits: number;
  window: number;
  bound: number | number[];
  /** 0: the published algorithm. */
  order: number | number[];
  /** `null`: no limit. */
  tolerance?: number | null;
  roundOffset?: number;
  encoding: "base85" | "base85x2";
}

export type Vector = [number, number, number];

export interface Joint {
  name: string;
  /** Index of the parent, -1 for the root; always smaller than the joint's own. */
  parent: number;
  /** From the parent's joint, in the parent's frame. */
  offset: Vector;
  channels: ("tx" | "ty" | "tz" | "rx" | "ry" | "rz" | "l")[];
  /** ASF: angles of the local frame in which the channels turn. */
  axis: Vector;
  /** In which order these turn, about fixed axes. */
  axisOrder: string;
  /** Far ends of bones that carry no further joint, in this joint's frame. */
  ends: Vector[];
}

export interface Skeleton {
  /** A joint's rotation: product of its channels' from left to right, or (`fixed`) from right to left. */
  rotation: "moving" | "fixed";
  angleUnit: "deg" | "rad";
  lengthUnit: number | null;
  joints: Joint[];
  /** Of each channel: index of its joint (-1: none) and kind (`"rx"`). */
  columns: [number, string][];
}

export interface Clip {
  names: string[];
  frames: number;
  /** One array of `frames` values for each name. */
  channels: Float64Array[];
  params: Params;
  skeleton?: Skeleton;
  /** Seconds. */
  frameTime?: number;
  /** Opaque; lets mocapress write the AMC or BVH file again. */
  layout?: string;
}

/** Decodes a document, given as text or as what `JSON.parse` made of it. Throws `DiffmaError`. */
export function decode(source: string | object, options?: DecodeOptions): Clip;
