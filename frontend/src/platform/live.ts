import {
  type DefaultError,
  type QueryKey,
  type UseQueryOptions,
  type UseQueryResult,
  useQuery,
  useQueryClient,
} from "@tanstack/react-query";
import { useEffect, useState } from "react";

const POLL_MS = 2_000;
const REOPEN_MS = 10_000;

/**
 * A query kept fresh by server-sent events while `isFinal` says no. Where events do not come through (a proxy that
 * holds them back, a server that restarts) it asks every two seconds, and goes on trying to listen.
 */
export function useLiveQuery<Data, Key extends QueryKey>(
  options: UseQueryOptions<Data, DefaultError, Data, Key>,
  eventsUrl: string,
  isFinal: (data: Data) => boolean,
): UseQueryResult<Data> {
  const cache = useQueryClient();
  const [isListening, setListening] = useState(false);
  const query = useQuery({
    ...options,
    refetchInterval: ({ state }) =>
      isListening || (state.data !== undefined && isFinal(state.data as Data)) ? false : POLL_MS,
  });
  const isOver = query.data === undefined || isFinal(query.data);
  const key = JSON.stringify(options.queryKey);

  useEffect(() => {
    if (isOver) return;
    const queryKey = JSON.parse(key) as QueryKey;
    return listen(eventsUrl, (data) => cache.setQueryData(queryKey, data), setListening);
  }, [isOver, eventsUrl, key, cache]);

  return query;
}

/** Listen to `changed` events until the returned function is called. `EventSource` comes back by itself, except when the answer was an error: then we do. */
export function listen(
  url: string,
  onChanged: (data: unknown) => void,
  onListening: (isListening: boolean) => void,
): () => void {
  let source: EventSource | undefined;
  let timer: ReturnType<typeof setTimeout> | undefined;
  const open = () => {
    source = new EventSource(url);
    source.addEventListener("open", () => onListening(true));
    source.addEventListener("changed", (event) => onChanged(JSON.parse(event.data)));
    source.addEventListener("error", () => {
      onListening(false);
      if (source?.readyState === EventSource.CLOSED) timer = setTimeout(open, REOPEN_MS);
    });
  };
  open();
  return () => {
    clearTimeout(timer);
    source?.close();
    onListening(false);
  };
}
