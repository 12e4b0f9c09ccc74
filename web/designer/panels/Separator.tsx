import type { KeyboardEvent, PointerEvent } from "react";
import { follow } from "../pointer";

interface Props {
  label: string;
  /** The id of what it gives its size. */
  controls: string;
  value: number;
  range: readonly [least: number, most: number];
  /** The value as it is said. */
  text: string;
  /** What a key changes, and with Shift. */
  steps: readonly [usual: number, fine: number];
  /** The change of the value when the separator moves a pixel to the right. */
  perPixel: () => number;
  onChange: (value: number) => void;
  onUsual: () => void;
  onFold?: () => void;
}

/** The edge between two pieces of the page, moved by the pointer or the arrows. */
export function Separator({ label, controls, value, range, text, steps, perPixel, ...on }: Props) {
  const grab = (event: PointerEvent<HTMLDivElement>) => {
    if (event.button !== 0) return;
    const [from, by] = [event.clientX, perPixel()];
    follow(event.currentTarget, event.pointerId, {
      move: (next) => on.onChange(value + (next.clientX - from) * by),
      done: (cancelled) => cancelled && on.onChange(value),
    });
  };
  const key = (event: KeyboardEvent) => {
    const step = steps[event.shiftKey ? 1 : 0] * Math.sign(perPixel());
    if (event.key === "ArrowRight") on.onChange(value + step);
    else if (event.key === "ArrowLeft") on.onChange(value - step);
    else if (event.key === "Home") on.onChange(range[0]);
    else if (event.key === "End") on.onChange(range[1]);
    else if (event.key === "Enter" && on.onFold) on.onFold();
    else return;
    event.preventDefault();
  };
  return (
    // biome-ignore lint/a11y/useSemanticElements: a separator that is moved is no line in a text
    <div
      role="separator"
      className="separator"
      aria-orientation="vertical"
      aria-label={label}
      aria-controls={controls}
      aria-valuemin={range[0]}
      aria-valuemax={range[1]}
      aria-valuenow={value}
      aria-valuetext={text}
      title={`${label}: drag it, or use the arrows. Double click: the usual width`}
      tabIndex={0}
      data-testid={`edge-${controls}`}
      onPointerDown={grab}
      onKeyDown={key}
      onDoubleClick={on.onUsual}
    />
  );
}
