import { useQuery } from "@tanstack/react-query";
import { Navigate } from "@tanstack/react-router";
import { useEffect, useState } from "react";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import { SignIn } from "./SignIn";
import { isIn, sessionQuery, useSignIn } from "./session";

/** /sign-in#SECRET: what stands behind the # lets this browser in, once. */
export function SignInPage() {
  const session = useQuery(sessionQuery);
  const { mutate, error, isPending } = useSignIn();
  const [secret] = useState(() => window.location.hash.slice(1));
  const isNew = session.data !== undefined && session.data.person === null;

  useEffect(() => {
    if (secret === "" || !isNew) return;
    // A link stands in the history of the browser; its secret need not.
    window.history.replaceState(window.history.state, "", window.location.pathname);
    mutate({ link: secret });
  }, [secret, isNew, mutate]);

  if (session.data === undefined || isPending) return <Loading />;
  if (session.data.person !== null && isIn(session.data)) return <Navigate to="/" replace />;
  return (
    <>
      {error && <ProblemAlert problem={toProblem(error)} />}
      <SignIn session={session.data} />
    </>
  );
}
