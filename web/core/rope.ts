// The rope over drum and sheaves: straight tangents joined by arcs, in one plane, and the shape of a slack span.

export interface Disc {
  readonly x: number;
  readonly z: number;
  readonly radius: number;
  /** Which way a rope runs round it, seen with x right and z up: over the top from left to right is clockwise, -1. */
  readonly turn: 1 | -1;
}

export type Point2 = readonly [number, number];

/**
 * Direct or crossed tangent from disc `a` to disc `b` (a radius of zero is a point): where the rope leaves `a` and
 * where it meets `b`. Null when one disc lies inside the other.
 */
export function tangent(a: Disc, b: Disc): [Point2, Point2] | null {
  const dx = b.x - a.x;
  const dz = b.z - a.z;
  const d = Math.hypot(dx, dz);
  const along = b.turn * b.radius - a.turn * a.radius;
  if (d <= Math.abs(along) || d === 0) return null;
  // Along the span (cos t, sin t) the contact points stand off their centres by turn * radius to the right.
  const t = Math.atan2(dz, dx) - Math.asin(along / d);
  const [nx, nz] = [Math.sin(t), -Math.cos(t)];
  return [
    [a.x + a.turn * a.radius * nx, a.z + a.turn * a.radius * nz],
    [b.x + b.turn * b.radius * nx, b.z + b.turn * b.radius * nz],
  ];
}

/** Points along the arc of `disc` from `from` to `to`, both on its rim, running its way; ends included. */
export function arc(disc: Disc, from: Point2, to: Point2, step = 0.15): Point2[] {
  const start = Math.atan2(from[1] - disc.z, from[0] - disc.x);
  let sweep = (Math.atan2(to[1] - disc.z, to[0] - disc.x) - start) * disc.turn;
  sweep -= 2 * Math.PI * Math.floor(sweep / (2 * Math.PI));
  if (sweep > 1.75 * Math.PI) sweep = 0; // nearly a full turn is a rope that just fails to touch the sheave
  const count = Math.max(1, Math.ceil(sweep / step));
  return Array.from({ length: count + 1 }, (_, i): Point2 => {
    const angle = start + (disc.turn * sweep * i) / count;
    return [disc.x + disc.radius * Math.cos(angle), disc.z + disc.radius * Math.sin(angle)];
  });
}

/** Polyline of the rope from the first disc (drum) over the others to `end`. */
export function ropePath(discs: readonly Disc[], end: Point2): Point2[] {
  const stops = [...discs, { x: end[0], z: end[1], radius: 0, turn: -1 } satisfies Disc];
  const path: Point2[] = [];
  let arrived: Point2 | null = null;
  for (let i = 0; i + 1 < stops.length; i += 1) {
    const span = tangent(stops[i], stops[i + 1]) ?? [
      [stops[i].x, stops[i].z],
      [stops[i + 1].x, stops[i + 1].z],
    ];
    if (arrived) path.push(...arc(stops[i], arrived, span[0]));
    else path.push(span[0]);
    arrived = span[1];
  }
  path.push(end);
  return path;
}

/**
 * Sideways bow [m] in the middle of a span of straight length `straight` that holds `length` of rope: the flat parabola
 * with that arc length, s = d + 8 f^2 / (3 d). Zero when the rope is taut.
 */
export function slackBow(straight: number, length: number): number {
  return length > straight ? Math.sqrt((3 / 8) * straight * (length - straight)) : 0;
}
