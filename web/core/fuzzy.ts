// Finding a line by a few of its letters.

const START = 8;
const NEXT = 9;
const GAP = 0.2;

/**
 * How well a text fits what was typed: larger is better, null if its letters are not there in order. Letters at the start
 * of words, and next to each other, count more; letters left out between them count a little less. Each word typed is
 * looked for by itself.
 */
export function closeness(text: string, typed: string): number | null {
  let sum = 0;
  for (const word of typed.toLowerCase().split(/\s+/).filter(Boolean)) {
    const found = ofWord(text.toLowerCase(), word);
    if (found === null) return null;
    sum += found;
  }
  return sum;
}

/** The best of all ways to find the letters of a word in order. */
function ofWord(text: string, word: string): number | null {
  // best[i]: of the ways that end with the letter so far at place i of the text
  let best: (number | null)[] = [];
  for (let k = 0; k < word.length; k += 1) {
    const next: (number | null)[] = new Array(text.length).fill(null);
    let reached: number | null = null;
    for (let i = 0; i < text.length; i += 1) {
      if (reached !== null) reached -= GAP;
      const before = i > 0 ? best[i - 1] : null;
      if (text[i] === word[k]) {
        const starts = i === 0 || !/[\p{L}\p{N}]/u.test(text[i - 1]) ? START : 1;
        if (k === 0) next[i] = starts;
        else {
          const ways = [before == null ? null : before + NEXT, reached === null ? null : reached + starts];
          const known = ways.filter((way) => way !== null);
          next[i] = known.length ? Math.max(...known) : null;
        }
      }
      if (before != null) reached = Math.max(reached ?? Number.NEGATIVE_INFINITY, before);
    }
    best = next;
  }
  return best.reduce((most, value) => (value !== null && (most === null || value > most) ? value : most), null);
}
