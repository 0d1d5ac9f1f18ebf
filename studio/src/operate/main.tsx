import { createRoot } from "react-dom/client";
import { takeToken } from "../connection";
import "../styles/colours.css";
import "../styles/base.css";
import "./operate.css";
import { Operate } from "./Operate";
import { open } from "./unit";

takeToken(window.location, window.history, window.sessionStorage);
open();

const root = document.getElementById("root");
if (root) createRoot(root).render(<Operate />);
