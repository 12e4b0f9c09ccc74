import { useBench, useDesigner } from "../context";

/** What the last order came to. */
export function Notice() {
  const { designer } = useBench();
  const notice = useDesigner((state) => state.notice);
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
