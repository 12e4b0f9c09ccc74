const ARROWS: Readonly<Record<string, string>> = {
  ArrowLeft: "\u2190",
  ArrowRight: "\u2192",
  ArrowUp: "\u2191",
  ArrowDown: "\u2193",
};

/** What is printed on a key, by its code. */
export function keyName(code: string): string {
  return ARROWS[code] ?? code.replace(/^Key/, "");
}
