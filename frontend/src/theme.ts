import { type CSSVariablesResolver, createTheme, Modal } from "@mantine/core";

export const theme = createTheme({
  primaryColor: "cyan",
  // Shades whose text on white, and white on which, reach a contrast of 4.5.
  primaryShade: { light: 9, dark: 9 },
  fontFamily: "'Inter Variable', system-ui, -apple-system, 'Segoe UI', sans-serif",
  fontFamilyMonospace: "ui-monospace, 'SF Mono', Menlo, Consolas, monospace",
  defaultRadius: "sm",
  cursorType: "pointer",
  respectReducedMotion: true,
  components: {
    Modal: Modal.extend({
      // The header of a dialogue is no banner of the page.
      defaultProps: {
        closeButtonProps: { "aria-label": "Close" },
        attributes: { header: { role: "presentation" } },
      },
    }),
  },
  headings: {
    fontWeight: "600",
    sizes: {
      h1: { fontSize: "1.625rem", lineHeight: "1.25" },
      h2: { fontSize: "1.125rem", lineHeight: "1.35" },
      h3: { fontSize: "0.9375rem", lineHeight: "1.4" },
    },
  },
});

/** Mantine's greys for secondary text are too faint to read on our grounds (WCAG AA asks for 4.5). */
export const readableVariables: CSSVariablesResolver = () => ({
  variables: {},
  light: {
    "--mantine-color-dimmed": "#5a6570",
    "--mantine-color-placeholder": "#6b7580",
    "--mantine-color-error": "#c92a2a",
    "--mantine-primary-color-filled-hover": "#095f70",
    "--mantine-color-cyan-filled-hover": "#095f70",
    "--mantine-primary-color-light": "#e3f4f7",
    "--mantine-color-cyan-light": "#e3f4f7",
    "--mantine-primary-color-light-hover": "#d2ecf1",
    "--mantine-color-cyan-light-hover": "#d2ecf1",
    "--mantine-color-teal-light": "#e0f4ec",
    "--mantine-color-teal-light-color": "#07694b",
    "--mantine-color-orange-light": "#fdf0e1",
    "--mantine-color-orange-light-color": "#8f4508",
    "--mantine-color-red-light": "#fdeaea",
    "--dropflow-ground": "#f7f8f9",
    "--dropflow-line": "#dfe3e7",
    "--dropflow-axis": "#7b858e",
  },
  dark: {
    "--mantine-color-dimmed": "#a9b2ba",
    "--mantine-color-placeholder": "#98a1a9",
    "--mantine-color-error": "#ff8787",
    "--mantine-primary-color-filled-hover": "#095f70",
    "--mantine-color-cyan-filled-hover": "#095f70",
    "--dropflow-ground": "#17191c",
    "--dropflow-line": "#383d42",
    "--dropflow-axis": "#8d969e",
  },
});
