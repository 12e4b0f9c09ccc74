// Shapes of crane and ship as plain triangles, flat-shaded where steel is plated: each triangle has its own corners.
import type { ShipDimensions, Vec3 } from "../rpc/messages";

export type Point2 = readonly [number, number];

/** Corners of triangles, nine numbers each, counter-clockwise seen from outside. */
export class Triangles {
  readonly corners: number[] = [];

  triangle(a: Vec3, b: Vec3, c: Vec3): void {
    this.corners.push(...a, ...b, ...c);
  }

  quad(a: Vec3, b: Vec3, c: Vec3, d: Vec3): void {
    this.triangle(a, b, c);
    this.triangle(a, c, d);
  }

  /** Skin between rings of equally many points, each ring clockwise or counter-clockwise seen from the first to the last. */
  loft(rings: readonly (readonly Vec3[])[], caps: boolean): void {
    for (let r = 0; r + 1 < rings.length; r += 1) {
      const [near, far] = [rings[r], rings[r + 1]];
      for (let i = 0; i < near.length; i += 1) {
        const j = (i + 1) % near.length;
        this.quad(near[i], near[j], far[j], far[i]);
      }
    }
    if (!caps) return;
    const [first, last] = [rings[0], rings[rings.length - 1]];
    for (let i = 1; i + 1 < first.length; i += 1) {
      this.triangle(first[0], first[i + 1], first[i]);
      this.triangle(last[0], last[i], last[i + 1]);
    }
  }
}

export interface Station {
  readonly x: number;
  readonly top: number;
  readonly bottom: number;
  readonly half: number;
}

/** A tapered box girder along x with chamfered edges, as plate girders of cranes are. */
export function girder(stations: readonly Station[], chamfer = 0.07): Triangles {
  const solid = new Triangles();
  solid.loft(
    stations.map(({ x, top, bottom, half }): Vec3[] => {
      const c = Math.min(chamfer, half / 3);
      return [
        [x, -half, bottom + c],
        [x, -half + c, bottom],
        [x, half - c, bottom],
        [x, half, bottom + c],
        [x, half, top - c],
        [x, half - c, top],
        [x, -half + c, top],
        [x, -half, top - c],
      ].map(([a, b, d]): Vec3 => [a, b, d]);
    }),
    true,
  );
  return solid;
}

/** Stations of the main boom over its length: slim at the heel pin, deepest where the cylinders push, slim at the knuckle. */
export function boomStations(length: number, push: number): Station[] {
  const u = Math.min(0.6, Math.max(0.2, push / length));
  const s = length / 18;
  return [
    { x: -0.55 * s, top: 0.42 * s, bottom: -0.42 * s, half: 0.8 * s },
    { x: 0.5 * s, top: 0.62 * s, bottom: -0.55 * s, half: 0.8 * s },
    { x: u * length, top: 1.08 * s, bottom: -0.62 * s, half: 0.74 * s },
    { x: 0.8 * length, top: 0.88 * s, bottom: -0.62 * s, half: 0.66 * s },
    { x: 0.955 * length, top: 0.62 * s, bottom: -0.55 * s, half: 0.62 * s },
  ];
}

/** Stations of the jib from its knuckle pin to where its head begins. */
export function jibStations(length: number, push: number): Station[] {
  const s = length / 14;
  return [
    { x: -0.45 * s, top: 0.36 * s, bottom: -0.36 * s, half: 0.42 * s },
    { x: 0.4 * s, top: 0.5 * s, bottom: -0.5 * s, half: 0.42 * s },
    { x: push, top: 0.62 * s, bottom: -0.66 * s, half: 0.42 * s },
    { x: 0.6 * length, top: 0.46 * s, bottom: -0.44 * s, half: 0.38 * s },
    { x: 0.93 * length, top: 0.3 * s, bottom: -0.28 * s, half: 0.34 * s },
  ];
}

/** Top and bottom of a girder at x, between its stations. */
export function sectionAt(stations: readonly Station[], x: number): Station {
  for (let i = 1; i < stations.length; i += 1) {
    const [a, b] = [stations[i - 1], stations[i]];
    if (x <= b.x || i === stations.length - 1) {
      const u = Math.min(1, Math.max(0, (x - a.x) / (b.x - a.x)));
      const mix = (p: number, q: number) => p + (q - p) * u;
      return { x, top: mix(a.top, b.top), bottom: mix(a.bottom, b.bottom), half: mix(a.half, b.half) };
    }
  }
  return stations[0];
}

/** Outline of a lug plate: round about its pin, widening to the line z = `root` where it is welded on. */
export function lug(pin: Point2, root: number, rim: number, spread: number): Point2[] {
  const away = Math.sign(pin[1] - root) || 1;
  const points: Point2[] = [
    [pin[0] - spread, root],
    [pin[0] + spread, root],
  ];
  for (let i = 0; i <= 12; i += 1) {
    const angle = (Math.PI * i) / 12;
    points.push([pin[0] + rim * Math.cos(angle), pin[1] + away * rim * Math.sin(angle)]);
  }
  return points;
}

// ---------------------------------------------------------------- ship
/** Lines of a supply vessel: long parallel body, raked and flared bow over a fine waterline, buttocks that rise to a transom. */
export class HullLines {
  readonly deck: number;
  readonly forecastle: number;
  /** Where the forecastle begins. */
  readonly breakX: number;

  constructor(readonly ship: ShipDimensions) {
    this.deck = ship.depth - ship.draught;
    this.forecastle = this.deck + 0.033 * ship.length;
    this.breakX = 0.14 * ship.length;
  }

  /** Top of the side plating with its bulwark. */
  sheer(x: number): number {
    const { length } = this.ship;
    if (x < this.breakX) return this.deck + 1.3;
    const ahead = (x - this.breakX) / (0.5 * length - this.breakX);
    return this.forecastle + 1.1 + 0.022 * length * ahead * ahead;
  }

  /** Bottom at x. */
  keel(x: number): number {
    const { length, draught } = this.ship;
    const aft = Math.max(0, (-0.2 * length - x) / (0.3 * length));
    return -draught + 0.8 * draught * aft ** 1.7;
  }

  /** Foremost point at a height. */
  stem(z: number): number {
    const { length, draught } = this.ship;
    const h = (z + draught) / (draught + this.forecastle);
    return length * (0.43 + 0.085 * Math.min(1.3, Math.max(0, h)) ** 0.9);
  }

  /** Half-breadth at a point. */
  half(x: number, z: number): number {
    const { length, beam, draught } = this.ship;
    const shoulder = 0.1 * length;
    const h = Math.min(1.2, Math.max(0, (z + draught) / (draught + this.deck)));
    const u = Math.min(1, Math.max(0, (x - shoulder) / (this.stem(z) - shoulder)));
    const fore = 1 - u ** (1.75 + 1.1 * h);
    const aft = 1 - 0.06 * Math.max(0, (-0.3 * length - x) / (0.2 * length)) ** 2;
    const bilge = 0.16 * beam;
    const above = Math.min(bilge, Math.max(0, z - this.keel(x)));
    const round = bilge - Math.sqrt(Math.max(0, bilge ** 2 - (bilge - above) ** 2));
    return Math.max(0, (beam / 2) * fore * aft - round * Math.min(1, fore * 1.2));
  }
}

/** Side plating between two heights given along the ship, both sides, with the transom; smooth enough to shade as steel. */
export function plating(
  lines: HullLines,
  low: (x: number) => number,
  high: (x: number) => number,
  rows: number,
  columns = 72,
): Triangles {
  const { length } = lines.ship;
  const solid = new Triangles();
  const at = (column: number, row: number): Vec3 => {
    // Columns crowd at the bow and at the break of the forecastle; the last lies on the stem at every height.
    const u = column / columns;
    const nominal = -0.5 * length + length * (1 - (1 - u) ** 1.25);
    const z = low(nominal) + ((high(nominal) - low(nominal)) * row) / rows;
    const shoulder = 0.1 * length;
    const fore = Math.max(0, (nominal - shoulder) / (0.5 * length - shoulder));
    const x = nominal < shoulder ? nominal : shoulder + fore * (lines.stem(z) - shoulder);
    return [x, lines.half(x, z), z];
  };
  const mirrored = ([x, y, z]: Vec3): Vec3 => [x, -y, z];
  for (let c = 0; c < columns; c += 1) {
    for (let r = 0; r < rows; r += 1) {
      const [a, b, d, e] = [at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)];
      solid.quad(b, a, e, d);
      solid.quad(mirrored(a), mirrored(b), mirrored(d), mirrored(e));
    }
  }
  for (let r = 0; r < rows; r += 1) {
    const [a, b] = [at(0, r), at(0, r + 1)];
    solid.quad(a, mirrored(a), mirrored(b), b);
  }
  return solid;
}

/** A deck at height z between two places along the ship, inside the plating. */
export function deckPlate(lines: HullLines, z: number, from: number, to: number, columns = 40): Triangles {
  const solid = new Triangles();
  const at = (i: number): Vec3 => {
    const x = from + ((to - from) * i) / columns;
    return [x, Math.max(0, lines.half(x, z) - 0.04), z];
  };
  for (let i = 0; i < columns; i += 1) {
    const [a, b] = [at(i), at(i + 1)];
    solid.quad([a[0], -a[1], z], [b[0], -b[1], z], b, a);
  }
  return solid;
}

/** A strake of constant height along both sides, standing out from the plating: the fender of a working ship. */
export function fender(lines: HullLines, z: number, height: number, out: number, columns = 60): Triangles {
  const solid = new Triangles();
  const { length } = lines.ship;
  const ring = (i: number, side: number): Vec3[] => {
    const x = -0.5 * length + (0.93 * length * i) / columns;
    const y = lines.half(x, z);
    const points: Vec3[] = [
      [x, side * (y - 0.05), z - height / 2],
      [x, side * (y + out), z - height / 3],
      [x, side * (y + out), z + height / 3],
      [x, side * (y - 0.05), z + height / 2],
    ];
    return side > 0 ? points : points.reverse();
  };
  for (const side of [1, -1]) {
    solid.loft(
      Array.from({ length: columns + 1 }, (_, i) => ring(i, side)),
      true,
    );
  }
  return solid;
}
