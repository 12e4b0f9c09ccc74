import { Component, type ReactNode } from "react";

/** Where the picture cannot be drawn (no WebGL), the instruments and the controls still work; this says so. */
export class Fallback extends Component<{ children: ReactNode }, { reason: string | null }> {
  state = { reason: null };

  static getDerivedStateFromError(error: unknown): { reason: string } {
    return { reason: error instanceof Error ? error.message : String(error) };
  }

  render(): ReactNode {
    if (this.state.reason === null) return this.props.children;
    return (
      <div className="notice" role="alert" data-testid="no-picture">
        <h2>The picture cannot be drawn</h2>
        <p>Instruments, plots and controls work without it. It needs WebGL 2 in the browser.</p>
        <p className="error-text">{this.state.reason}</p>
      </div>
    );
  }
}
