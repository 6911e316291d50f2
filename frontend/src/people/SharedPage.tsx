import { useMutation } from "@tanstack/react-query";
import { useNavigate } from "@tanstack/react-router";
import { useEffect, useState } from "react";
import { sessionCreate } from "../client";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import { useEnter } from "./session";

/** /shared#SECRET: look at one run, without an account. */
export function SharedPage() {
  const [secret] = useState(() => window.location.hash.slice(1));
  const navigate = useNavigate();
  const enter = useEnter();
  const { mutate, error } = useMutation({
    mutationFn: async (share: string) => (await sessionCreate({ body: { share } })).data,
    onSuccess: async (session) => {
      enter(session);
      if (session.shared_run_id)
        await navigate({ to: "/runs/$runId", params: { runId: session.shared_run_id }, replace: true });
    },
  });
  useEffect(() => mutate(secret), [mutate, secret]);
  return error ? <ProblemAlert problem={toProblem(error)} /> : <Loading />;
}
