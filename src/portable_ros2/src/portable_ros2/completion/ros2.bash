# Completion of `ros2` for bash: `source` this file, for instance in ~/.bashrc.
# The first TAB asks argcomplete for what it needs, so that a new terminal does not wait for it.

_ros2_load_completion() {
    local register
    complete -r ros2
    for register in register-python-argcomplete register-python-argcomplete3; do
        if type -P "$register" >/dev/null; then
            eval "$("$register" ros2)"
            return 124  # bash tries again, with what this has set
        fi
    done
}
complete -o default -F _ros2_load_completion ros2
