import {
  ActionIcon,
  Anchor,
  AppShell,
  Button,
  Container,
  Group,
  Text,
  useComputedColorScheme,
  useMantineColorScheme,
} from "@mantine/core";
import { IconMoon, IconPlus, IconSun } from "@tabler/icons-react";
import { Link, Outlet, useRouterState } from "@tanstack/react-router";
import { useEffect, useRef } from "react";
import { AccountMenu } from "../people/AccountMenu";
import { Gate } from "../people/Gate";
import { Logo } from "./Logo";

/** The frame around every page: header, one main landmark, footer. */
export function Shell() {
  const main = useFocusOnNavigation();
  return (
    <AppShell header={{ height: 56 }} padding={0}>
      <a className="skip-link" href="#main">
        Skip to the content
      </a>
      <AppShell.Header>
        <Container size={1440} h="100%">
          <Group h="100%" justify="space-between" wrap="nowrap">
            <Group gap="lg" wrap="nowrap">
              <HomeLink />
              <MainLinks />
            </Group>
            <Group gap="xs" wrap="nowrap">
              <Button
                renderRoot={(props) => <Link to="/experiments/new" {...props} />}
                size="xs"
                leftSection={<IconPlus size={16} aria-hidden />}
              >
                New experiment
              </Button>
              <SchemeSwitch />
              <AccountMenu />
            </Group>
          </Group>
        </Container>
      </AppShell.Header>
      <AppShell.Main ref={main} id="main" tabIndex={-1} style={{ outline: "none" }}>
        <Container size={1440} py="lg">
          <Gate>
            <Outlet />
          </Gate>
        </Container>
      </AppShell.Main>
    </AppShell>
  );
}

/** A new page begins at its top for keyboards and screen readers too, as a loaded page would. */
function useFocusOnNavigation() {
  const main = useRef<HTMLElement>(null);
  const path = useRouterState({ select: ({ location }) => location.pathname });
  const seen = useRef(path);
  useEffect(() => {
    if (seen.current === path) return;
    seen.current = path;
    main.current?.focus({ preventScroll: true });
  }, [path]);
  return main;
}

function HomeLink() {
  return (
    <Anchor
      renderRoot={(props) => <Link to="/" {...props} />}
      underline="never"
      c="inherit"
      aria-label="Dropflow: all experiments"
    >
      <Group gap={10} wrap="nowrap">
        <Text span c="var(--mantine-color-anchor)" lh={0}>
          <Logo />
        </Text>
        <Text span fw={650} fz="lg" lts="-0.01em">
          Dropflow
        </Text>
      </Group>
    </Anchor>
  );
}

const PLACES = [
  {
    to: "/",
    name: "Experiments",
    isHere: (path: string) => path === "/" || /^\/(experiments|runs)\b/.test(path),
  },
  { to: "/compare", name: "Compare", isHere: (path: string) => path.startsWith("/compare") },
  { to: "/planning", name: "Planning", isHere: (path: string) => path.startsWith("/planning") },
  { to: "/trash", name: "Trash", isHere: (path: string) => path.startsWith("/trash") },
] as const;

/** The places of the service; where one is, is said to everybody. */
function MainLinks() {
  const path = useRouterState({ select: ({ location }) => location.pathname });
  return (
    <Group component="nav" gap={4} wrap="nowrap" aria-label="Main">
      {PLACES.map(({ to, name, isHere }) => (
        <Anchor
          key={to}
          className="main-link"
          underline="never"
          renderRoot={(props) => <Link to={to} aria-current={isHere(path) ? "page" : undefined} {...props} />}
        >
          {name}
        </Anchor>
      ))}
    </Group>
  );
}

function SchemeSwitch() {
  const { setColorScheme } = useMantineColorScheme();
  const scheme = useComputedColorScheme("light");
  const other = scheme === "dark" ? "light" : "dark";
  return (
    <ActionIcon
      variant="subtle"
      color="gray"
      size="lg"
      aria-label={`Use ${other} colours`}
      onClick={() => setColorScheme(other)}
    >
      {scheme === "dark" ? <IconSun size={18} aria-hidden /> : <IconMoon size={18} aria-hidden />}
    </ActionIcon>
  );
}
