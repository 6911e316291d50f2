import { queryOptions, useMutation, useQueryClient } from "@tanstack/react-query";
import { type Session, type SignIn, sessionCreate, sessionDelete, sessionGet } from "../client";

/** Who is signed in in this browser, and how one can. */
export const sessionQuery = queryOptions({
  queryKey: ["session"],
  queryFn: async ({ signal }) => (await sessionGet({ signal })).data,
  staleTime: 60_000,
});

/** Whether there is anything to see: somebody is signed in, or came by the link to a shared run. */
export function isIn(session: Session): boolean {
  return session.person !== null || session.shared_run_id !== null;
}

/** Sign in; what was shown to whoever was here before is forgotten. */
export function useSignIn() {
  const enter = useEnter();
  return useMutation({
    mutationFn: async (said: SignIn) => (await sessionCreate({ body: said })).data,
    onSuccess: enter,
  });
}

/** Begin anew as who is in `session` now. */
export function useEnter() {
  const cache = useQueryClient();
  return (session: Session) => {
    // The question who is in stays the same one: whoever waits for its answer hears the new one.
    cache.removeQueries({ predicate: ({ queryKey }) => queryKey[0] !== sessionQuery.queryKey[0] });
    cache.setQueryData(sessionQuery.queryKey, session);
  };
}

export function useSignOut() {
  return useMutation({
    mutationFn: () => sessionDelete(),
    // Everything that this page holds in memory goes, too.
    onSuccess: () => window.location.assign(document.baseURI),
  });
}
