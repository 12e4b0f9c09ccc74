import { useEffect } from "react";
import { useBench, useDesigner } from "../context";

const LONG_ENOUGH = 7000;

/** What the last order came to; what went wrong stays until it is closed. */
export function Notice() {
  const { designer } = useBench();
  const notice = useDesigner((state) => state.notice);
  useEffect(() => {
    if (notice?.kind !== "done") return;
    const timer = setTimeout(() => designer.hush(), LONG_ENOUGH);
    return () => clearTimeout(timer);
  }, [notice, designer]);
  return (
    <div className="notice-place" aria-live="polite">
      {notice && (
        <div className="notice" data-kind={notice.kind} data-testid="notice">
          <p>{notice.text}</p>
          <button type="button" aria-label="Close the message" onClick={() => designer.hush()}>
            {"\u00d7"}
          </button>
        </div>
      )}
    </div>
  );
}
