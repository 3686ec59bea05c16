# Completion of `ros2` for zsh: `source` this file, for instance in ~/.zshrc.

if (( ! $+functions[compdef] )); then
    autoload -Uz compinit
    compinit
fi
for _ros2_register in register-python-argcomplete register-python-argcomplete3; do
    if (( $+commands[$_ros2_register] )); then
        # What an older argcomplete writes is for bash.
        autoload -Uz bashcompinit
        bashcompinit
        eval "$($_ros2_register ros2)"
        break
    fi
done
unset _ros2_register
