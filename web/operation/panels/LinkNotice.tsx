import { Button } from "@mantine/core";
import { usePage, useSession } from "./usePage";

/** What stands in the way, in words, and what to do about it. */
export function LinkNotice() {
  const session = useSession();
  const link = usePage((page) => page.link);
  const error = usePage((page) => page.status?.error ?? null);
  const notice = usePage((page) => page.notice);
  const seen = usePage((page) => page.model !== null);
  if (link === "refused") {
    return (
      <div className="notice" role="alert" data-testid="notice">
        <h2>The server wants its token</h2>
        <p>
          Open the address that <code>seacrane demo</code> printed when it started; it ends in <code>?token=</code> and
          a long word. A token is good until the server stops.
        </p>
      </div>
    );
  }
  if (link === "lost" || (link === "connecting" && seen)) {
    return (
      <div className="notice" role="alert" data-testid="notice">
        <h2>Link lost</h2>
        <p>
          The server stops the crane by itself when it hears nothing for half a second. What the instruments show is
          what they showed last. Trying to reach the server again.
        </p>
      </div>
    );
  }
  if (error) {
    return (
      <div className="notice" role="alert" data-testid="notice">
        <h2>The simulation stopped</h2>
        <p className="error-text">{error}</p>
        <Button size="xs" onClick={() => session.reset()}>
          Start again
        </Button>
      </div>
    );
  }
  if (notice) {
    return (
      <div className="notice" role="alert" data-testid="notice">
        <p>{notice}</p>
        <Button size="xs" variant="default" onClick={() => session.dismiss()}>
          Close
        </Button>
      </div>
    );
  }
  return null;
}
