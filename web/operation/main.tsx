import "@mantine/core/styles.css";
import "./style.css";
import { createTheme, MantineProvider } from "@mantine/core";
import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./App";
import { Session } from "./session";

const theme = createTheme({
  primaryColor: "cyan",
  fontFamily: "system-ui, 'Segoe UI', Roboto, 'Liberation Sans', 'Helvetica Neue', Arial, sans-serif",
  defaultRadius: "sm",
  respectReducedMotion: true,
});

const address = new URL("./rpc", window.location.href);
address.protocol = address.protocol === "https:" ? "wss:" : "ws:";
address.search = "";
address.hash = "";
const session = new Session(address.href);

createRoot(document.getElementById("root")!).render(
  <StrictMode>
    <MantineProvider theme={theme} defaultColorScheme="auto">
      <App session={session} />
    </MantineProvider>
  </StrictMode>,
);
