# One image for all processes; docker-compose.yml says which command each runs.
FROM python:3.11-slim
WORKDIR /opt/muster
COPY pyproject.toml constraints.txt README.md ./
COPY agents agents
COPY bus bus
COPY encodings encodings
COPY ops ops
COPY reasoning reasoning
COPY world world
RUN pip install --no-cache-dir --constraint constraints.txt .
# Nothing but the installed packages: no folder of ours in the working directory may be imported by accident.
WORKDIR /run/muster
STOPSIGNAL SIGTERM
CMD ["muster", "--help"]
