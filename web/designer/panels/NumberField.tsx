import { type KeyboardEvent, type PointerEvent, useEffect, useId, useRef, useState } from "react";
import { alike, factor, parsed, type UnitSymbol, written } from "../../core/design/quantity";
import { symbol } from "../../core/units";
import { follow } from "../pointer";

/** A step for so many pixels, and what Shift makes of a step. */
const PIXELS = 4;
const FINE = 0.1;

interface Props {
  label: string;
  value: number | null | undefined;
  unit: UnitSymbol;
  hint?: string;
  /** Shown where there is no value; without it, a value is needed. */
  absent?: string;
  problem?: string | null;
  /** Why a value cannot be, in words; null if it can. */
  check?: (value: number) => string | null;
  onChange: (value: number | undefined) => void;
  /**
   * While it is dragged: the first call begins what `onDragged` ends, or takes back. Without them the value is given once,
   * when the drag ends.
   */
  onDrag?: (value: number) => void;
  onDragged?: (cancelled: boolean) => void;
  compact?: boolean;
}

/** A quantity with its unit: typed, reckoned (`18 + 0.5`, `8 ft`), stepped by the arrows, dragged. */
export function NumberField(props: Props) {
  const { label, value, unit, hint, absent, problem, check, onChange, onDrag, onDragged, compact } = props;
  const id = useId();
  const settled = value == null ? "" : written(value, unit);
  const [text, setText] = useState(settled);
  const [error, setError] = useState<string | null>(null);
  useEffect(() => {
    setText(settled);
    setError(null);
  }, [settled]);

  const commit = () => {
    if (text === settled) return setError(null);
    if (!text.trim() && absent !== undefined) return onChange(undefined);
    try {
      const next = parsed(text, unit);
      const wrong = check?.(next) ?? null;
      if (wrong) return setError(wrong);
      setError(null);
      if (value != null && Math.abs(next - value) <= 1e-12 * Math.abs(value)) setText(settled);
      else onChange(next);
    } catch (failure) {
      setError((failure as Error).message);
    }
  };
  const key = (event: KeyboardEvent) => {
    if (event.key === "Enter") commit();
    if (event.key === "Escape") {
      setText(settled);
      setError(null);
    }
    const direction = event.key === "ArrowUp" ? 1 : event.key === "ArrowDown" ? -1 : 0;
    if (!direction || value == null) return;
    event.preventDefault();
    const next = stepped(value, unit, direction * (event.shiftKey ? FINE : 1));
    if (!check?.(next)) onChange(next);
  };
  const held = useRef(false);
  const drag = (event: PointerEvent<HTMLElement>) => {
    const element = event.currentTarget;
    if (value == null || event.button !== 0 || document.activeElement === element) return;
    // A finger on a number scrolls the panel, and a tap types in it.
    if (element instanceof HTMLInputElement && event.pointerType !== "mouse") return;
    held.current = true;
    const from = event.clientX;
    let result: number | null = null;
    follow(element, event.pointerId, {
      move: (next) => {
        const by = Math.trunc((next.clientX - from) / PIXELS);
        if (result === null && by === 0) return;
        const moved = stepped(value, unit, by * (next.shiftKey ? FINE : 1));
        if (check?.(moved)) return;
        result = moved;
        if (onDrag) onDrag(moved);
        else setText(written(moved, unit));
      },
      done: (cancelled) => {
        held.current = false;
        if (result === null) return element instanceof HTMLInputElement && !cancelled ? element.focus() : undefined;
        if (onDrag) onDragged?.(cancelled);
        else if (cancelled) setText(settled);
        else onChange(result);
      },
    });
  };
  const message = error ?? problem;
  return (
    <div className="field" data-compact={compact} data-wrong={Boolean(message)}>
      <label htmlFor={id} title={hint} data-drags={value != null} onPointerDown={drag}>
        {label}
      </label>
      <input
        id={id}
        value={text}
        placeholder={absent}
        inputMode="text"
        autoComplete="off"
        spellCheck={false}
        aria-invalid={Boolean(message)}
        aria-describedby={message ? `${id}-wrong` : undefined}
        title={`${hint ? `${hint}. ` : ""}Also in ${alike(unit).join(", ")}`}
        data-drags={value != null}
        onPointerDown={drag}
        onMouseDown={(event) => held.current && event.preventDefault()}
        onChange={(event) => setText(event.currentTarget.value)}
        onFocus={(event) => event.currentTarget.select()}
        onBlur={commit}
        onKeyDown={key}
      />
      <span className="unit">{unit === "1" ? "" : symbol(unit)}</span>
      {message && (
        <p id={`${id}-wrong`} className="wrong">
          {message}
        </p>
      )}
    </div>
  );
}

/** A step in the third digit, whole steps of a round size. */
function stepped(value: number, unit: UnitSymbol, by: number): number {
  const shown = value / factor(unit);
  const size = unit === "deg" ? 1 : 10 ** (Math.floor(Math.log10(Math.max(Math.abs(shown), 1e-3))) - 1);
  return Number((shown + by * size).toPrecision(10)) * factor(unit);
}
