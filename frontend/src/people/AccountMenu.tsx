import { Button, Menu } from "@mantine/core";
import { IconKey, IconLogout, IconSettings, IconUserCircle, IconUsers } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { sessionQuery, useSignOut } from "./session";

/** Who one is here, and the pages about that. */
export function AccountMenu() {
  const { data: session } = useQuery(sessionQuery);
  const signOut = useSignOut();
  const person = session?.person;
  if (!session || !person) return null;
  return (
    <Menu position="bottom-end" withinPortal>
      <Menu.Target>
        <Button
          variant="subtle"
          color="gray"
          size="xs"
          leftSection={<IconUserCircle size={18} aria-hidden />}
        >
          {person.name}
        </Button>
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Item
          renderRoot={(props) => <Link to="/account" {...props} />}
          leftSection={<IconKey size={16} aria-hidden />}
        >
          Account and tokens
        </Menu.Item>
        <Menu.Item
          renderRoot={(props) => <Link to="/groups" {...props} />}
          leftSection={<IconUsers size={16} aria-hidden />}
        >
          Groups
        </Menu.Item>
        {person.is_administrator && (
          <Menu.Item
            renderRoot={(props) => <Link to="/administration" {...props} />}
            leftSection={<IconSettings size={16} aria-hidden />}
          >
            Administration
          </Menu.Item>
        )}
        <Menu.Divider />
        <Menu.Item onClick={() => signOut.mutate()} leftSection={<IconLogout size={16} aria-hidden />}>
          Sign out
        </Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
}
