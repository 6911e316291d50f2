import type { FieldError, Problem } from "../client";

/** An error the API described (problem+json), or the lack of an answer told in the same form. */
export class ProblemError extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail);
    this.name = "ProblemError";
  }
}

export const UNREACHABLE: Problem = {
  type: "about:blank",
  title: "No answer",
  status: 0,
  code: "network.unreachable",
  detail: "The server does not answer.",
  hint: "Is it running, and are you connected?",
};

/** What an API answer with an error status says, whatever its body is. */
export function problemFromAnswer(body: unknown, status: number, statusText = ""): Problem {
  if (typeof body === "object" && body !== null && "code" in body && "detail" in body) return body as Problem;
  return {
    type: "about:blank",
    title: statusText || "Unexpected answer",
    status,
    code: `http.${status}`,
    detail: `The server answered with status ${status}${statusText ? ` (${statusText})` : ""}.`,
  };
}

export function toProblem(error: unknown): Problem {
  if (error instanceof ProblemError) return error.problem;
  return {
    type: "about:blank",
    title: "This page met an error",
    status: 0,
    code: "page.error",
    detail: error instanceof Error ? error.message : String(error),
    hint: "Reload the page. If it happens again, report it with what you did before.",
  };
}

/** Messages by field path, e.g. `{"material.viscosity_pa_s": "must be greater than 0"}`. */
export function fieldMessages(problem: Problem | null | undefined): Record<string, string> {
  const messages: Record<string, string> = {};
  for (const { field, message } of problem?.errors ?? ([] as FieldError[])) {
    messages[field] = messages[field] ? `${messages[field]}; ${message}` : message;
  }
  return messages;
}
