{{- define "dropflow.name" -}}
{{- if contains "dropflow" .Release.Name }}{{ .Release.Name | trunc 40 | trimSuffix "-" }}{{ else }}{{ printf "%s-dropflow" .Release.Name | trunc 40 | trimSuffix "-" }}{{ end -}}
{{- end }}

{{- define "dropflow.labels" -}}
app.kubernetes.io/name: dropflow
app.kubernetes.io/instance: {{ .Release.Name }}
app.kubernetes.io/version: {{ .Chart.AppVersion | quote }}
app.kubernetes.io/managed-by: {{ .Release.Service }}
helm.sh/chart: {{ printf "%s-%s" .Chart.Name .Chart.Version }}
{{- end }}

{{/* What selects the pods of one part: (list $ "api") */}}
{{- define "dropflow.selector" -}}
app.kubernetes.io/name: dropflow
app.kubernetes.io/instance: {{ (index . 0).Release.Name }}
app.kubernetes.io/component: {{ index . 1 }}
{{- end }}

{{- define "dropflow.image" -}}
{{ .Values.image.repository }}:{{ .Values.image.tag | default .Chart.AppVersion }}
{{- end }}

{{- define "dropflow.podSecurity" -}}
automountServiceAccountToken: false
securityContext:
  runAsNonRoot: true
  runAsUser: 10001
  runAsGroup: 10001
  fsGroup: 10001
  seccompProfile: {type: RuntimeDefault}
{{- with .Values.imagePullSecrets }}
imagePullSecrets: {{ toYaml . | nindent 2 }}
{{- end }}
{{- end }}

{{- define "dropflow.containerSecurity" -}}
securityContext:
  allowPrivilegeEscalation: false
  readOnlyRootFilesystem: true
  capabilities: {drop: [ALL]}
{{- end }}

{{/* What each of our own containers has: image, settings, scratch space. What it does is said as `args`: `command` would
     take the place of the image's entrypoint, which puts compiled code where it is found. */}}
{{- define "dropflow.container" -}}
image: {{ include "dropflow.image" . }}
imagePullPolicy: {{ .Values.image.pullPolicy }}
{{ include "dropflow.containerSecurity" . }}
envFrom:
  - configMapRef: {name: {{ include "dropflow.name" . }}}
  - secretRef: {name: {{ .Values.secrets.name }}}
volumeMounts:
  - {name: work, mountPath: /var/lib/dropflow/work}
  - {name: tmp, mountPath: /tmp}
{{- end }}

{{- define "dropflow.volumes" -}}
- name: work
  emptyDir: {sizeLimit: {{ .Values.work.sizeLimit }}}
- name: tmp
  emptyDir: {sizeLimit: 2Gi}
{{- end }}

{{/* A pod waits until the migration job has brought the database to its version's form. */}}
{{- define "dropflow.await" -}}
- name: await-database
  {{- include "dropflow.container" . | nindent 2 }}
  args: [dropflow-server, await-database]
  resources:
    requests: {cpu: 10m, memory: 128Mi}
    limits: {memory: 256Mi}
{{- end }}

{{/* What the database must let in: 41 an API process, 4 a worker and 2 for each of its processes, and 15 others. */}}
{{- define "dropflow.connections" -}}
{{- $n := add 15 (mul 41 (int .Values.api.replicas)) }}
{{- range .Values.workers }}
{{- $replicas := int .replicas }}
{{- if ne $.Values.autoscaling.kind "none" }}{{ $replicas = max $replicas (int (.maxReplicas | default .replicas)) }}{{ end }}
{{- $n = add $n (mul $replicas (add 4 (mul 2 (int .concurrency)))) }}
{{- end }}
{{- $n }}
{{- end }}

{{/* A change of the settings is a change of the pods. */}}
{{- define "dropflow.checksum" -}}
checksum/settings: {{ include (print .Template.BasePath "/settings.yaml") . | sha256sum }}
{{- end }}
