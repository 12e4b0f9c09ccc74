export const VIEWS = [
  { view: "overview", label: "Overview" },
  { view: "side", label: "Side" },
  { view: "deck", label: "Deck" },
  { view: "cab", label: "Cab" },
  { view: "hook", label: "Hook" },
] as const;

export type View = (typeof VIEWS)[number]["view"];
