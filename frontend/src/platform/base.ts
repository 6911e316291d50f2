/** Where the app is mounted, with a slash at the end: `<base>` in index.html says it. */
export const mountUrl = new URL(".", document.baseURI).href;

/** The router's base path, e.g. `/` or `/dropflow/`. */
export const mountPath = new URL(mountUrl).pathname;

/**
 * Take `<base>` out of the document once it was read: with it Plotly's clip paths (`url(#id)`) would point away from
 * the page as soon as the address changes.
 */
export function forgetBaseElement(): void {
  document.querySelector("base")?.remove();
}

type Query = Record<string, string | number | undefined>;

/** Address of an API resource: `apiUrl(["runs", id, "files", name])`. Each part is one path segment, percent-encoded. */
export function apiUrl(parts: (string | number)[], query: Query = {}): string {
  const url = new URL(`api/v1/${parts.map((part) => encodeURIComponent(part)).join("/")}`, mountUrl);
  for (const [name, value] of Object.entries(query)) {
    if (value !== undefined) url.searchParams.set(name, String(value));
  }
  return url.href;
}
