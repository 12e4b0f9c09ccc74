import { Modal } from "@mantine/core";
import { useState } from "react";
import { useBench } from "../context";
import { keepVersions, type Version, versions } from "../saving";

/** States of designs kept in this browser under a name, to go back to. */
export function VersionsDialog({ open, onClose }: { open: boolean; onClose: () => void }) {
  return (
    <Modal
      opened={open}
      onClose={onClose}
      title="Versions in this browser"
      size="lg"
      transitionProps={{ duration: 80 }}
    >
      <Versions onClose={onClose} />
    </Modal>
  );
}

function Versions({ onClose }: { onClose: () => void }) {
  const { designer } = useBench();
  const [kept, setKept] = useState(versions);
  const { crane } = designer.store.getState();
  const [name, setName] = useState(unused(crane.name, kept));
  const [removed, setRemoved] = useState<{ readonly version: Version; readonly before: readonly Version[] } | null>(
    null,
  );
  const keep = (next: readonly Version[]) => {
    try {
      keepVersions(next);
      setKept([...next]);
      setName(unused(crane.name, next));
      setRemoved(null);
    } catch {
      designer.tell("This browser keeps no more: remove versions, or save to a file.", "wrong");
    }
  };
  return (
    <div className="dialog">
      <div className="field">
        <label>
          <span>Name</span>
          <input value={name} onChange={(event) => setName(event.currentTarget.value)} />
        </label>
        <button
          type="button"
          data-testid="keep-version"
          onClick={() => keep([{ name: name.trim() || crane.name, at: Date.now(), crane }, ...kept])}
        >
          Keep this state
        </button>
      </div>
      <ul className="versions">
        {kept.map((version) => (
          <li key={version.at}>
            <span>
              {version.name} <small>{new Date(version.at).toLocaleString()}</small>
            </span>
            <button
              type="button"
              aria-label={`Open ${version.name}`}
              onClick={() => {
                designer.open(version.crane);
                onClose();
              }}
            >
              Open
            </button>
            <button
              type="button"
              aria-label={`Remove ${version.name}`}
              onClick={() => {
                keep(kept.filter((other) => other !== version));
                setRemoved({ version, before: kept });
              }}
            >
              Remove
            </button>
          </li>
        ))}
      </ul>
      {removed && (
        <p className="hint" role="status">
          {removed.version.name} is removed.{" "}
          <button type="button" className="plain" onClick={() => keep(removed.before)}>
            Put it back
          </button>
        </p>
      )}
      {kept.length === 0 && <p className="hint">None yet. The work itself is kept by itself, once a second.</p>}
    </div>
  );
}

/** The crane's name with the least number that no version has yet. */
function unused(name: string, kept: readonly Version[]): string {
  let i = 1;
  while (kept.some((version) => version.name === `${name} ${i}`)) i += 1;
  return `${name} ${i}`;
}
