"""A provider of sign-ins beside passwords."""

from typing import Self

from pydantic import Field, SecretStr, model_validator

from backend.platform.settings_base import EnvironmentSettings


class ProviderSettings(EnvironmentSettings):
    """Where people sign in with what their organisation gave them."""

    oidc_issuer: str | None = None
    """A provider of sign-ins (OpenID Connect) beside passwords, such as `https://login.example.org/realms/lab`."""
    oidc_client_id: str | None = None
    """What the provider knows this service as."""
    oidc_client_secret: SecretStr | None = None
    """The secret that belongs to it."""
    oidc_scope: str = "openid email profile"
    """What the provider is asked for."""
    oidc_name: str = "your organisation"
    """What the page calls the provider."""
    oidc_groups_claim: str = "groups"
    """The claim that says in which groups of the provider somebody is."""
    oidc_groups: dict[str, str] = Field(default_factory=dict)
    """JSON: group of the provider to group and right here, such as `{"lab-foams": "Foams:edit"}`."""

    @model_validator(mode="after")
    def _provider_is_whole(self) -> Self:
        if self.oidc_issuer is None:
            return self
        if not self.oidc_client_id:
            raise ValueError("OIDC_ISSUER needs AUTH=accounts and OIDC_CLIENT_ID")
        for place in self.oidc_groups.values():
            name, _, right = place.rpartition(":")
            if not name or right not in ("view", "edit", "manage"):
                raise ValueError(f"OIDC_GROUPS: {place!r} must be GROUP:view, GROUP:edit or GROUP:manage")
        return self
