// Addresses of streams and files that peers tell (IOP, Digital Resource Discovery).

export interface Endpoint {
  href: string;
  /** What the browser does with it, or why it does nothing. */
  why: string;
  /** Whether a tab of the browser can open it. */
  isPage: boolean;
  /** Commands for a shell. */
  commands: string[];
}

const FILES = ["ftp:", "sftp:", "scp:"];
const STREAMS = ["rtsp:", "rtp:", "udp:"];
const PAGES = ["http:", "https:"];

/** What can be done with an address; undefined for what is none. */
export function endpointOf(text: string): Endpoint | undefined {
  if (/[\s\\]/.test(text) || !URL.canParse(text)) return undefined;
  const { protocol, href, host } = new URL(text);
  if (!host || ![...FILES, ...STREAMS, ...PAGES].includes(protocol)) return undefined;
  // A shell takes nothing between such quotes for more than a text.
  const quoted = `'${href.replaceAll("'", "'\\''")}'`;
  const isPage = PAGES.includes(protocol);
  const name = protocol.slice(0, -1).toUpperCase();
  return {
    href,
    isPage,
    why: isPage
      ? "Nothing connects to what the vehicle told unless you do it:"
      : FILES.includes(protocol)
        ? `Browsers do not speak ${name}. This copies the file:`
        : `Browsers do not speak ${name}. Either of these plays it:`,
    commands: FILES.includes(protocol)
      ? [`curl -O ${quoted}`]
      : [`ffplay ${quoted}`, `gst-launch-1.0 playbin uri=${quoted}`],
  };
}
