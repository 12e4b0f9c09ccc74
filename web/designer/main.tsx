import "@mantine/core/styles.css";
import "./style.css";
import { createTheme, MantineProvider } from "@mantine/core";
import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./App";
import { Charts } from "./charts";
import { keepChecked } from "./checking";
import { createLayout } from "./layout";
import { openLink } from "./link";
import { autosave, recovered } from "./saving";
import { createSearch } from "./search";
import { checked, given, placed } from "./server";
import { SHIPPED } from "./shipped";
import { createDesigner } from "./store";
import { createView } from "./view";

const FIRST = "offshore-100t";

const theme = createTheme({
  primaryColor: "cyan",
  fontFamily: "system-ui, 'Segoe UI', Roboto, 'Liberation Sans', 'Helvetica Neue', Arial, sans-serif",
  defaultRadius: "sm",
  respectReducedMotion: true,
  components: { Modal: { defaultProps: { closeButtonProps: { "aria-label": "Close" } } } },
});

const [kept, asked] = [recovered(), await given()];
const first = kept?.crane ?? asked ?? (await (SHIPPED.find(({ name }) => name === FIRST) ?? SHIPPED[0]).load());
const designer = createDesigner(first, kept?.posture);
if (kept && asked && asked.name !== kept.crane.name) {
  designer.open(asked);
  designer.tell(
    `Opened ${asked.name}, as the command asked. Undo brings back the recovered work on ${kept.crane.name}.`,
  );
} else if (kept) {
  const time = new Date(kept.at).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" });
  designer.tell(`Recovered the work on ${first.name} of ${time}. New starts another crane.`);
}
keepChecked(designer, async (crane) => (await checked(crane)).map(placed));
autosave(designer, (reason) => designer.tell(reason, "wrong"));

const bench = {
  designer,
  view: createView(designer),
  search: createSearch(designer),
  layout: createLayout(),
  sections: new Charts(),
  curves: new Charts(),
};

// The fragment goes once it is read: a reload finds the work since then, not the link again.
const follow = () => {
  if (location.hash.length < 2) return;
  const link = location.hash;
  history.replaceState(null, "", location.pathname + location.search);
  openLink(bench, link).catch((error: Error) => designer.tell(error.message, "wrong"));
};
follow();
addEventListener("hashchange", follow);

createRoot(document.getElementById("root")!).render(
  <StrictMode>
    <MantineProvider theme={theme} defaultColorScheme="auto">
      <App bench={bench} />
    </MantineProvider>
  </StrictMode>,
);
