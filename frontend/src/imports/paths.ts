/** `2024/run 1` as steps to click on, each with the path it leads to; the first is the root. */
export function steps(root: string, path: string): { name: string; path: string }[] {
  const parts = path ? path.split("/") : [];
  return [
    { name: root, path: "" },
    ...parts.map((name, index) => ({ name, path: parts.slice(0, index + 1).join("/") })),
  ];
}

export function below(path: string, name: string): string {
  return path ? `${path}/${name}` : name;
}
