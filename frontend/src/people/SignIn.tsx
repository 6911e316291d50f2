import {
  Anchor,
  Button,
  Center,
  Code,
  Paper,
  PasswordInput,
  Stack,
  Text,
  TextInput,
  Title,
} from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import { useState } from "react";
import type { Session } from "../client";
import { mountUrl } from "../platform/base";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { useSignIn } from "./session";

/** What stands in the place of every page as long as nobody is signed in; the page itself appears afterwards. */
export function SignIn({ session }: { session: Session }) {
  useDocumentTitle("Sign in · Dropflow");
  return (
    <Center mih="60vh">
      <Paper withBorder p="xl" w={400} maw="100%">
        <Stack>
          <Title order={1}>Sign in</Title>
          {session.ways.includes("oidc") && <Elsewhere name={session.oidc_name ?? "your organisation"} />}
          {session.ways.includes("password") && <WithPassword />}
          {session.ways.includes("link") && <WithLink />}
        </Stack>
      </Paper>
    </Center>
  );
}

function Elsewhere({ name }: { name: string }) {
  const here = window.location.href.slice(mountUrl.length);
  return (
    <Button
      component="a"
      href={`${mountUrl}api/v1/session/oidc?next=${encodeURIComponent(`/${here}`)}`}
      variant="default"
      fullWidth
    >
      Sign in with {name}
    </Button>
  );
}

function WithPassword() {
  const signIn = useSignIn();
  const [email, setEmail] = useState("");
  const [password, setPassword] = useState("");
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        signIn.mutate({ email, password });
      }}
    >
      <Stack>
        <TextInput
          label="E-mail"
          type="email"
          autoComplete="username"
          required
          withAsterisk={false}
          value={email}
          onChange={(event) => setEmail(event.currentTarget.value)}
        />
        <PasswordInput
          label="Password"
          autoComplete="current-password"
          required
          withAsterisk={false}
          value={password}
          onChange={(event) => setPassword(event.currentTarget.value)}
        />
        {signIn.error && <ProblemAlert problem={toProblem(signIn.error)} />}
        <Button type="submit" loading={signIn.isPending}>
          Sign in
        </Button>
        <Text fz="sm" c="dimmed">
          No account, or the password forgotten? Whoever looks after this server can give you a link.
        </Text>
      </Stack>
    </form>
  );
}

/** On one's own machine there are no passwords: the program that was started says the way in. */
function WithLink() {
  const signIn = useSignIn();
  const [link, setLink] = useState("");
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        signIn.mutate({ link: link.trim().replace(/^.*#/, "") });
      }}
    >
      <Stack>
        <Text fz="sm">
          Open the link that <Code>make run</Code> printed when it started. Each link works once;{" "}
          <Code>make sign-in</Code> prints another. Or paste one here:
        </Text>
        <TextInput
          label="Link"
          required
          withAsterisk={false}
          autoComplete="off"
          value={link}
          onChange={(event) => setLink(event.currentTarget.value)}
        />
        {signIn.error && <ProblemAlert problem={toProblem(signIn.error)} />}
        <Button type="submit" loading={signIn.isPending}>
          Sign in
        </Button>
      </Stack>
    </form>
  );
}

export function BackToStart() {
  return <Anchor href={mountUrl}>To the start</Anchor>;
}
