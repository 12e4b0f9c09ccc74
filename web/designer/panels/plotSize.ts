import { useElementSize } from "@mantine/hooks";
import type { RefCallback } from "react";

const LEAST_WIDTH = 240;

/** The size of a plot that is as wide as its panel [px]: `share` of the width high, at most `most`. */
export function usePlotSize(share: number, most: number) {
  const size = useElementSize();
  const width = Math.max(size.width, LEAST_WIDTH);
  // The hook observes any element; its type knows only those of HTML.
  const ref = size.ref as unknown as RefCallback<SVGSVGElement>;
  return { ref, width, height: Math.min(share * width, most) };
}
