import { Button } from "@mantine/core";
import { Link } from "@tanstack/react-router";
import { Empty } from "./Empty";
import { Page } from "./Page";

export function NothingHere() {
  return (
    <Page title="Nothing here">
      <Empty
        title="There is no page at this address"
        action={<Button renderRoot={(props) => <Link to="/" {...props} />}>All experiments</Button>}
      >
        The address may be mistyped, or what it showed was deleted.
      </Empty>
    </Page>
  );
}
