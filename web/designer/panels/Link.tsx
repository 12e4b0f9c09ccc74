import { Modal } from "@mantine/core";
import { useEffect, useState } from "react";
import { useBench } from "../context";
import { addressOf, openLink } from "../link";

/** The link to the design as it is seen, to be copied by hand; and a link of somebody else, to be opened. */
export function LinkDialog({ open, onClose }: { open: boolean; onClose: () => void }) {
  return (
    <Modal opened={open} onClose={onClose} title="Link to a design" size="lg" transitionProps={{ duration: 80 }}>
      {open && <Links />}
    </Modal>
  );
}

function Links() {
  const bench = useBench();
  const [own, setOwn] = useState("");
  const [given, setGiven] = useState("");
  const [wrong, setWrong] = useState<string | null>(null);
  useEffect(() => {
    addressOf(bench)
      .then(setOwn)
      .catch((error) => setOwn((error as Error).message));
  }, [bench]);
  const follow = async () => {
    try {
      await openLink(bench, given);
    } catch (error) {
      setWrong((error as Error).message);
    }
  };
  return (
    <div className="dialog" data-testid="link-dialog">
      <label className="long">
        <span>Open a link</span>
        <input
          value={given}
          data-autofocus
          autoComplete="off"
          spellCheck={false}
          aria-invalid={wrong !== null}
          aria-describedby="link-wrong"
          onChange={(event) => {
            setGiven(event.currentTarget.value);
            setWrong(null);
          }}
          onKeyDown={(event) => event.key === "Enter" && void follow()}
        />
      </label>
      <p id="link-wrong" className="wrong" role="alert">
        {wrong}
      </p>
      <button type="button" className="primary" disabled={!given.trim()} onClick={follow}>
        Open
      </button>
      <p className="hint">
        A link of another computer, or of a designer that ran before, is pasted here: only what follows its # counts.
        What you are at is kept as a version.
      </p>
      <label className="long">
        <span>Link to this design as you see it</span>
        <input readOnly value={own} data-testid="own-link" onFocus={(event) => event.currentTarget.select()} />
      </label>
    </div>
  );
}
