import { type KeyboardEvent, type PointerEvent, useEffect, useId, useState } from "react";
import { alike, factor, parsed, type UnitSymbol, written } from "../../core/design/quantity";
import { symbol } from "../../core/units";

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
  /** While the label is dragged: the first call begins what `onDragged` ends. */
  onDrag?: (value: number) => void;
  onDragged?: () => void;
  compact?: boolean;
}

/** A quantity with its unit: typed, reckoned (`18 + 0.5`, `8 ft`), stepped by the arrows, dragged by its label. */
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
    const next = stepped(value, unit, direction * (event.shiftKey ? 0.1 : 1));
    if (!check?.(next)) onChange(next);
  };
  const drag = (event: PointerEvent<HTMLLabelElement>) => {
    if (value == null || !onDrag || event.button !== 0) return;
    const element = event.currentTarget;
    const [x0, start] = [event.clientX, value];
    let moved = false;
    element.setPointerCapture(event.pointerId);
    const move = (next: globalThis.PointerEvent) => {
      const by = Math.trunc((next.clientX - x0) / 4);
      if (!moved && by === 0) return;
      moved = true;
      const result = stepped(start, unit, by * (next.shiftKey ? 0.1 : 1));
      if (!check?.(result)) onDrag(result);
    };
    const up = () => {
      element.removeEventListener("pointermove", move);
      if (moved) onDragged?.();
    };
    element.addEventListener("pointermove", move);
    element.addEventListener("lostpointercapture", up, { once: true });
  };
  const message = error ?? problem;
  return (
    <div className="field" data-compact={compact} data-wrong={Boolean(message)}>
      <label htmlFor={id} title={hint} data-drags={Boolean(onDrag) && value != null} onPointerDown={drag}>
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
