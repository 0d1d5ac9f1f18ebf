import { useEffect, useState } from "react";
import { messageOf } from "../actions";
import { Copyable, Quiet } from "../panels/base/parts";
import { endpointOf } from "./endpoints";
import type { Values } from "./protocol";
import { ask } from "./unit";

/** What a report has beside values: pictures, and where streams are. */
export default function Media({ values }: { values: Values }) {
  const { urls, component, report } = values;
  return (
    <>
      {values.pictures.map((path) => (
        <Picture key={path} values={values} path={path} />
      ))}
      {urls.length > 0 && (
        <ul className="endpoints" aria-label={`Streams and files that ${component} tells`}>
          {urls.map((each) => (
            <Endpoint key={each} text={each} component={component} report={report} />
          ))}
        </ul>
      )}
    </>
  );
}

/** The last picture of a report, again with each report. */
function Picture({ values, path }: { values: Values; path: string }) {
  const { component, report, count, age } = values;
  const [url, setUrl] = useState("");
  const [reason, setReason] = useState("");
  // biome-ignore lint/correctness/useExhaustiveDependencies: each report has another picture
  useEffect(() => {
    let isWanted = true;
    ask("picture", { component, report, path }).then(
      (found) => {
        if (!isWanted) return;
        setUrl(found.url);
        setReason("");
      },
      (error: unknown) => isWanted && setReason(messageOf(error)),
    );
    return () => {
      isWanted = false;
    };
  }, [component, report, path, count]);
  if (reason) return <Quiet>{`${path} is no picture that is shown here: ${reason}.`}</Quiet>;
  return (
    <figure className="picture">
      {url && (
        <img
          src={url}
          alt={`${path} of ${component}`}
          onError={() => setReason("the browser cannot read it")}
        />
      )}
      <figcaption>
        {path} of {component}, picture {count}, {age} s old
      </figcaption>
    </figure>
  );
}

interface Told {
  text: string;
  component: string;
  report: string;
}

/** An address that a peer told: nothing connects to it unless a person does. */
function Endpoint({ text, component, report }: Told) {
  const endpoint = endpointOf(text);
  if (!endpoint) return <li>{text} is no address of a stream or file.</li>;
  return (
    <li>
      <Copyable label={`the address ${endpoint.href}`} text={endpoint.href} />
      <p className="quiet">{endpoint.why}</p>
      {endpoint.isPage && (
        <>
          <Stream told={{ text, component, report }} host={endpoint.host} />
          <a href={endpoint.href} target="_blank" rel="noreferrer noopener">
            Open {endpoint.href} in a tab of its own
          </a>
        </>
      )}
      {endpoint.commands.map((each) => (
        <Copyable key={each} label={`the command ${each}`} text={each} />
      ))}
    </li>
  );
}

/** Video that the studio's server fetches for this page, once a person has asked for it. */
function Stream({ told, host }: { told: Told; host: string }) {
  const [isWanted, setIsWanted] = useState(false);
  const [shown, setShown] = useState<{ stream: string; is_video: boolean }>();
  const [reason, setReason] = useState("");
  const { text, component, report } = told;
  useEffect(() => {
    if (!isWanted) return;
    let stream = "";
    let isGone = false;
    const end = () => void ask("unstream", { stream }).catch(() => undefined);
    ask("stream", { component, report, url: text, host }).then(
      (found) => {
        stream = found.stream;
        if (isGone) end();
        else setShown(found);
      },
      (error: unknown) => {
        setReason(messageOf(error));
        setIsWanted(false);
      },
    );
    return () => {
      isGone = true;
      setShown(undefined);
      if (stream) end();
    };
  }, [isWanted, text, component, report, host]);
  const over = (why: string) => {
    setReason(why);
    setIsWanted(false);
  };
  const unread = "it has ended, or the browser cannot read it as it comes";
  const noVideo = `${unread}: an MP4 needs its index at its beginning`;
  const source = shown && `/stream/${shown.stream}`;
  return (
    <>
      <button
        type="button"
        onClick={() => {
          setReason("");
          setIsWanted(!isWanted);
        }}
      >
        {isWanted ? `Hide what comes from ${host}` : `Show: the studio connects to ${host}`}
      </button>
      {reason && <Quiet>{`${text} is not shown: ${reason}.`}</Quiet>}
      {source && (
        <figure className="picture">
          {shown.is_video ? (
            <video
              src={source}
              autoPlay
              muted
              controls
              onError={() => over(noVideo)}
              onEnded={() => over("it has ended")}
            />
          ) : (
            <img src={source} alt={`What ${host} shows`} onError={() => over(unread)} />
          )}
          <figcaption>
            {text}, as {component} tells it
          </figcaption>
        </figure>
      )}
    </>
  );
}
