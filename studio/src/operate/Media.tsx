import { useState } from "react";
import { Copyable, Quiet } from "../panels/base/parts";
import { Age, OLD_S } from "./Age";
import { endpointOf } from "./endpoints";
import type { Values } from "./protocol";
import { useAnswer } from "./unit";

/** What a report has beside values: pictures, and where streams are. */
export default function Media({ values }: { values: Values }) {
  const { urls, component } = values;
  return (
    <>
      {values.pictures.map((path) => (
        <Picture key={path} values={values} path={path} />
      ))}
      {urls.length > 0 && (
        <ul className="endpoints" aria-label={`Streams and files that ${component} tells`}>
          {urls.map((url) => (
            <Endpoint key={url} text={url} />
          ))}
        </ul>
      )}
    </>
  );
}

/** The last picture of a report, again with each report. */
function Picture({ values, path }: { values: Values; path: string }) {
  const { component, report, count, age } = values;
  const { value, error } = useAnswer("picture", { component, report, path }, count);
  const [unread, setUnread] = useState("");
  const url = value?.url ?? "";
  const reason = error || (url && url === unread ? "the browser cannot read it" : "");
  if (reason) return <Quiet>{`${path} is no picture that is shown here: ${reason}.`}</Quiet>;
  return (
    <figure className="picture">
      {url && <img src={url} alt={`${path} of ${component}`} onError={() => setUnread(url)} />}
      <figcaption>
        {path} of {component}, picture {count}, <Age seconds={age} limit={OLD_S} />
      </figcaption>
    </figure>
  );
}

/** An address that a peer told: nothing connects to it unless a person does. */
function Endpoint({ text }: { text: string }) {
  const endpoint = endpointOf(text);
  if (!endpoint) return <li>{text} is no address of a stream or file.</li>;
  return (
    <li>
      <Copyable label={`the address ${endpoint.href}`} text={endpoint.href} />
      <p className="quiet">{endpoint.why}</p>
      {endpoint.isPage && (
        <a href={endpoint.href} target="_blank" rel="noreferrer noopener">
          Open {endpoint.href} in a tab of its own
        </a>
      )}
      {endpoint.commands.map((command) => (
        <Copyable key={command} label={`the command ${command}`} text={command} />
      ))}
    </li>
  );
}
