import { useQuery } from "@tanstack/react-query";
import { useRouterState } from "@tanstack/react-router";
import type { ReactNode } from "react";
import { QueryView } from "../platform/QueryView";
import { SignIn } from "./SignIn";
import { isIn, sessionQuery } from "./session";

const OPEN = ["/sign-in", "/invitation", "/shared"];

/** Every page but those that let people in is for who is in; the address stays, so that they come where they wanted. */
export function Gate({ children }: { children: ReactNode }) {
  const session = useQuery(sessionQuery);
  const path = useRouterState({ select: ({ location }) => location.pathname });
  if (OPEN.includes(path)) return children;
  return (
    <QueryView query={session}>{(found) => (isIn(found) ? children : <SignIn session={found} />)}</QueryView>
  );
}
