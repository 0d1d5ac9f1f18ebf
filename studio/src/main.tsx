import { StrictMode } from "react";
import { createRoot } from "react-dom/client";
import { App } from "./App";
import { listener, use } from "./actions";
import { keepAddress, takeAddress } from "./address";
import { fitTexts } from "./canvas/fonts";
import { Connection, socketAddress, takeToken } from "./connection";
import "@xyflow/react/dist/base.css";
import "./styles/index.css";

takeAddress(window.location.hash, window.sessionStorage);
const token = takeToken(window.location, window.history, window.sessionStorage);
const connection = new Connection(socketAddress(window.location, "/socket"), token, listener);
use(connection);
connection.open();
keepAddress(window, window.sessionStorage);

fitTexts(document.documentElement);

const root = document.getElementById("root");
if (root) {
  createRoot(root).render(
    <StrictMode>
      <App />
    </StrictMode>,
  );
}
