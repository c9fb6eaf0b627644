# Starts Monado and an X server in the unpacked system, runs a program, and ends them. What they print goes to files in /tmp.
export HOME=/root XDG_RUNTIME_DIR=/run/monado XRT_COMPOSITOR_NULL=1 PATH=/usr/bin:/usr/sbin DISPLAY=:9
export XR_RUNTIME_JSON=/usr/share/openxr/1/openxr_monado.json
export VK_DRIVER_FILES=/usr/share/vulkan/icd.d/lvp_icd.json VK_ICD_FILENAMES=/usr/share/vulkan/icd.d/lvp_icd.json
has_failed() {
  local output
  output=$(tr -d '\0' < /tmp/output.log)
  [[ $output == *'SCRIPT ERROR'* || $output == *'Parse Error'* || $output == *'engine failed'* ]]
}
rm -rf /run/monado "$HOME/.local/state/parafovea" /tmp/.X9-lock /tmp/.X11-unix /tmp/output.log /tmp/samples.jsonl
mkdir -m 700 /run/monado
mkfifo /run/monado/input
exec 7<> /run/monado/input
Xvfb :9 -screen 0 320x240x24 > /tmp/xvfb.log 2>&1 &
display=$!
# Nothing was installed, so nobody chose between implementations of these libraries.
libraries=$(echo /usr/lib/*-linux-gnu)
LD_LIBRARY_PATH="$libraries/lapack:$libraries/blas" monado-service < /run/monado/input > /tmp/monado.log 2>&1 &
service=$!
for turn in $(seq 150); do test -S /run/monado/monado_comp_ipc && break; sleep 0.1; done
timeout "$1" "${@:2}" > /tmp/output.log 2>&1 &
application=$!
# A script that cannot go on leaves its engine running.
while kill -0 $application 2> /dev/null; do
  if has_failed; then
    sleep 3
    kill $application
    break
  fi
  sleep 0.5
done
wait $application
code=$?
has_failed && code=70
kill $service $display
wait
exit $code
