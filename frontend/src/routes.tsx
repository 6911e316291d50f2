import { createRootRoute, createRoute, createRouter, lazyRouteComponent } from "@tanstack/react-router";
import { compareSearch } from "./compare/address";
import { ExperimentsPage } from "./experiments/ExperimentsPage";
import { planSearch } from "./planning/wish";
import { mountPath } from "./platform/base";
import { NothingHere } from "./platform/NothingHere";
import { PageError } from "./platform/PageError";
import { Shell } from "./platform/Shell";
import { frameOf, runSearch } from "./results/view";

const root = createRootRoute({ component: Shell, notFoundComponent: NothingHere, errorComponent: PageError });

const experiments = createRoute({ getParentRoute: () => root, path: "/", component: ExperimentsPage });

const newExperiment = createRoute({
  getParentRoute: () => root,
  path: "/experiments/new",
  component: lazyRouteComponent(() => import("./experiments/NewExperimentPage"), "NewExperimentPage"),
});

const experiment = createRoute({
  getParentRoute: () => root,
  path: "/experiments/$experimentId",
  validateSearch: (search: Record<string, unknown>): { frame?: number } => ({ frame: frameOf(search) }),
  component: lazyRouteComponent(() => import("./experiments/ExperimentPage"), "ExperimentPage"),
});

const newRun = createRoute({
  getParentRoute: () => root,
  path: "/experiments/$experimentId/analyse",
  validateSearch: (search: Record<string, unknown>): { from?: string } => ({
    from: typeof search.from === "string" ? search.from : undefined,
  }),
  component: lazyRouteComponent(() => import("./runs/NewRunPage"), "NewRunPage"),
});

const run = createRoute({
  getParentRoute: () => root,
  path: "/runs/$runId",
  validateSearch: runSearch,
  component: lazyRouteComponent(() => import("./runs/RunPage"), "RunPage"),
});

const planning = createRoute({
  getParentRoute: () => root,
  path: "/planning",
  validateSearch: planSearch,
  component: lazyRouteComponent(() => import("./planning/PlanningPage"), "PlanningPage"),
});

const compare = createRoute({
  getParentRoute: () => root,
  path: "/compare",
  validateSearch: compareSearch,
  component: lazyRouteComponent(() => import("./compare/ComparePage"), "ComparePage"),
});

const signIn = createRoute({
  getParentRoute: () => root,
  path: "/sign-in",
  component: lazyRouteComponent(() => import("./people/SignInPage"), "SignInPage"),
});

const invitation = createRoute({
  getParentRoute: () => root,
  path: "/invitation",
  component: lazyRouteComponent(() => import("./people/InvitationPage"), "InvitationPage"),
});

const shared = createRoute({
  getParentRoute: () => root,
  path: "/shared",
  component: lazyRouteComponent(() => import("./people/SharedPage"), "SharedPage"),
});

const account = createRoute({
  getParentRoute: () => root,
  path: "/account",
  component: lazyRouteComponent(() => import("./people/AccountPage"), "AccountPage"),
});

const groups = createRoute({
  getParentRoute: () => root,
  path: "/groups",
  component: lazyRouteComponent(() => import("./groups/GroupsPage"), "GroupsPage"),
});

const group = createRoute({
  getParentRoute: () => root,
  path: "/groups/$groupId",
  component: lazyRouteComponent(() => import("./groups/GroupPage"), "GroupPage"),
});

const administration = createRoute({
  getParentRoute: () => root,
  path: "/administration",
  component: lazyRouteComponent(() => import("./administration/AdministrationPage"), "AdministrationPage"),
});

const trash = createRoute({
  getParentRoute: () => root,
  path: "/trash",
  component: lazyRouteComponent(() => import("./trash/TrashPage"), "TrashPage"),
});

const people = [signIn, invitation, shared, account, groups, group, administration];

export const router = createRouter({
  routeTree: root.addChildren([
    experiments,
    newExperiment,
    experiment,
    newRun,
    run,
    compare,
    planning,
    trash,
    ...people,
  ]),
  basepath: mountPath,
  defaultPreload: "intent",
  scrollRestoration: true,
});

declare module "@tanstack/react-router" {
  interface Register {
    router: typeof router;
  }
}
