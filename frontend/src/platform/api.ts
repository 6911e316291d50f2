import { client } from "../client/client.gen";
import { mountUrl } from "./base";
import { ProblemError, problemFromAnswer, UNREACHABLE } from "./problem";

/** Point the generated client at this server and make every failure a `ProblemError`. */
export function connectClient(): void {
  client.setConfig({ baseUrl: mountUrl.replace(/\/$/, "") });
  client.interceptors.error.use((body, response) => {
    if (body instanceof DOMException && body.name === "AbortError") return body;
    return new ProblemError(
      response ? problemFromAnswer(body, response.status, response.statusText) : UNREACHABLE,
    );
  });
}
