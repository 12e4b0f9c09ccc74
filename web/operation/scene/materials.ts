// Paint, steel and glass. One of each, shared: fewer programs, and the crane keeps one colour.
import { DoubleSide, MeshStandardMaterial } from "three";

const paint = (color: string, roughness = 0.55, metalness = 0.05) =>
  new MeshStandardMaterial({ color, roughness, metalness });

export const YELLOW = paint("#e2a31b");
export const YELLOW_DARK = paint("#b97f10");
export const RED = paint("#b5291f");
export const BLACK = paint("#17191b", 0.7);
export const STEEL = paint("#6a727a", 0.45, 0.6);
export const DARK_STEEL = paint("#333a41", 0.5, 0.5);
export const CHROME = new MeshStandardMaterial({ color: "#dfe5ea", roughness: 0.12, metalness: 1 });
export const WIRE = new MeshStandardMaterial({ color: "#2b2e31", roughness: 0.6, metalness: 0.4 });
export const GLASS = new MeshStandardMaterial({ color: "#14222c", roughness: 0.06, metalness: 0.7 });
export const WHITE = paint("#e9ecec", 0.5);
export const GREY = paint("#aab2b6", 0.6);
export const ORANGE = paint("#e4571b", 0.45);
export const CARGO = paint("#1f5f86", 0.5);
export const CARGO_FRAME = paint("#e8ebea", 0.5);
export const CONTAINER_GREEN = paint("#3f6b55", 0.6);
export const DECK = new MeshStandardMaterial({ color: "#5d5347", roughness: 0.9 });
export const DECK_GREEN = new MeshStandardMaterial({ color: "#41584d", roughness: 0.85 });
export const HULL = new MeshStandardMaterial({ color: "#22384c", roughness: 0.42, metalness: 0.1, side: DoubleSide });
export const BOTTOM = new MeshStandardMaterial({ color: "#8e2a22", roughness: 0.7, side: DoubleSide });
